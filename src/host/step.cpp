// Steps, what they report, state, recording.
#include "host/call.h"

using namespace sutura;
using namespace sutura::host;

namespace {

/// One step; what went wrong.
sutura_status step_once(Session& session) {
  Simulation& simulation = *session.simulation;
  if (const std::optional<Diagnostic>& failure = simulation.report().failure)
    return fail(static_cast<sutura_status>(failure->category),
                "no step is taken since a component failed: " + failure->text());
  if (!simulation.report().finite)
    return fail(SUTURA_DIVERGED, "no step is taken since the simulation has diverged");
  const StepReport& report = simulation.step();
  ++session.changes;
  for (const std::string& note : report.messages) session.tell(SUTURA_NOTE, note);
  for (const std::string& fault : report.faults) session.tell(SUTURA_WARNING, fault);
  if (!report.solved)
    session.tell(SUTURA_WARNING, "a step missed its tolerances; its report says by how much");
  if (report.missed()) ++session.missed;
  if (report.failure)
    return fail(static_cast<sutura_status>(report.failure->category), report.failure->text());
  if (!report.finite)
    return fail(SUTURA_DIVERGED, "diverged: the state is no longer finite after step " +
                                     std::to_string(report.step));
  if (session.recording && !simulation.record_error().empty())
    return fail(SUTURA_BAD_FILE, simulation.record_error());
  return ok;
}

sutura_status as_file_status(const std::string& problem) {
  return problem.empty() ? ok : fail(SUTURA_BAD_FILE, problem);
}

template <class Restore>
sutura_status restore(Session& session, const Restore& from) {
  if (session.recording)
    return fail(SUTURA_MISUSE, "a recording is under way; finish it before the state is changed");
  ++session.changes;
  const sutura_status status = as_file_status(from(*session.simulation));
  if (status == ok) session.missed = 0;
  return status;
}

template <class Begin>
sutura_status begin_recording(Session& session, const Begin& begin) {
  if (session.recording) return fail(SUTURA_MISUSE, "a recording is under way already");
  const std::string problem = begin(*session.simulation);
  session.recording = problem.empty();
  if (!problem.empty()) session.simulation->finish_recording();
  return as_file_status(problem);
}

}  // namespace

sutura_status sutura_step(sutura_simulation simulation, size_t count) {
  return with(simulation, Kind::simulation, &count, [&](Session& session, std::size_t) {
    sutura_status status = ok;
    for (std::size_t i = 0; i < count && status == ok; ++i) status = step_once(session);
    return status;
  });
}

sutura_status sutura_get_report(sutura_simulation simulation, sutura_report* report) {
  return with(simulation, Kind::simulation, report, [&](Session& session, std::size_t) {
    const StepReport& r = session.simulation->report();
    const Scene& scene = session.simulation->scene();
    return fill(report,
                {0, r.solved ? 1 : 0, r.step, r.time, scene.dt, scene.duration, r.rows, r.passes,
                 r.parts, r.solve.events, static_cast<int64_t>(r.faults.size()),
                 r.worst_imbalance().relative, r.violation, r.total_seconds(), session.missed});
  });
}

sutura_status sutura_write_scene(sutura_simulation simulation, const char** xml) {
  return with(simulation, Kind::simulation, xml, [&](Session& session, std::size_t) {
    session.xml = write_scene(session.simulation->scene());
    *xml = session.xml.c_str();
    return ok;
  });
}

sutura_status sutura_save(sutura_simulation simulation, const void** data, size_t* size) {
  const bool complete = data != nullptr && size != nullptr;
  return with(simulation, Kind::simulation, complete ? data : nullptr,
              [&](Session& session, std::size_t) {
                session.saved = session.simulation->save();
                if (const auto& failure = session.simulation->report().failure)
                  return fail(static_cast<sutura_status>(failure->category), failure->text());
                *data = session.saved.data();
                *size = session.saved.size();
                return ok;
              });
}

sutura_status sutura_restore(sutura_simulation simulation, const void* data, size_t size) {
  return with(simulation, Kind::simulation, data, [&](Session& session, std::size_t) {
    return restore(session, [&](Simulation& s) {
      return s.restore({static_cast<const std::byte*>(data), size});
    });
  });
}

sutura_status sutura_save_file(sutura_simulation simulation, const char* file) {
  return with(simulation, Kind::simulation, file, [&](Session& session, std::size_t) {
    return as_file_status(session.simulation->save(std::filesystem::path(file)));
  });
}

sutura_status sutura_restore_file(sutura_simulation simulation, const char* file) {
  return with(simulation, Kind::simulation, file, [&](Session& session, std::size_t) {
    return restore(session, [&](Simulation& s) { return s.restore(std::filesystem::path(file)); });
  });
}

sutura_status sutura_reset(sutura_simulation simulation) {
  return with(simulation, Kind::simulation, &simulation, [](Session& session, std::size_t) {
    return restore(session, [&](Simulation& s) { return s.restore(session.initial); });
  });
}

sutura_status sutura_start_recording(sutura_simulation simulation) {
  return with(simulation, Kind::simulation, &simulation, [](Session& session, std::size_t) {
    return begin_recording(session, [](Simulation& s) { return s.start_recording(); });
  });
}

sutura_status sutura_resume_recording(sutura_simulation simulation) {
  return with(simulation, Kind::simulation, &simulation, [](Session& session, std::size_t) {
    return begin_recording(session, [](Simulation& s) { return s.resume_recording(); });
  });
}

sutura_status sutura_finish_recording(sutura_simulation simulation) {
  return with(simulation, Kind::simulation, &simulation, [](Session& session, std::size_t) {
    if (!session.recording) return fail(SUTURA_MISUSE, "no recording is under way");
    session.recording = false;
    return as_file_status(session.simulation->finish_recording());
  });
}
