// Outputs and inputs by name: "/holder.force".
#include <algorithm>
#include <cmath>
#include <new>

#include "scene/output_failure.h"
#include "sutura/device.h"
#include "sutura/scene.h"
#include "sutura/units.h"

namespace sutura {
namespace {

std::string did_you_mean(const std::string& name, const std::vector<std::string>& candidates) {
  const std::string nearest = nearest_name(name, candidates);
  return nearest.empty() ? std::string() : "; did you mean '" + nearest + "'?";
}

std::string list_of(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& n : names) out += (out.empty() ? "" : ", ") + n;
  return out;
}

/// The component and what is called so in the list that `member` points to. `kind`: "output".
template <class Info>
std::pair<Component*, const Info*> search(const Scene& scene, std::string_view name,
                                          std::vector<Info> ComponentInfo::*member,
                                          const std::string& kind, std::string& error) {
  error.clear();
  const auto dot = name.rfind('.');
  if (dot == std::string_view::npos || dot == 0 || dot + 1 == name.size()) {
    error = "'" + std::string(name) + "': expected a component and its " + kind +
            ", as in /holder.force";
    return {};
  }
  const std::string owner(name.substr(0, dot)), wanted(name.substr(dot + 1));
  Component* component = scene.find(owner);
  if (component == nullptr) {
    std::vector<std::string> paths;
    for (const Component* c : scene.components()) paths.push_back(c->path());
    error =
        "no component '" + owner + "' for '" + std::string(name) + "'" + did_you_mean(owner, paths);
    return {};
  }
  std::vector<std::string> names;
  for (const Info& info : component->info().*member) {
    if (info.name == wanted) return {component, &info};
    names.push_back(info.name);
  }
  error = component->info().name + " '" + owner + "' has no " + kind + " '" + wanted + "'" +
          (names.empty() ? "; it has none"
                         : did_you_mean(wanted, names) + "; it has " + list_of(names));
  return {};
}

}  // namespace

OutputValue OutputHandle::read() const {
  try {
    return info->read(*component);
  } catch (const DeviceError&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw OutputFailure(*component, info->name, e.what());
  }
}

OutputHandle Scene::output(std::string_view name, std::string& error) const {
  const auto [component, info] = search(*this, name, &ComponentInfo::outputs, "output", error);
  return {component, info};
}

InputHandle Scene::input(std::string_view name, std::string& error) const {
  const auto [component, info] = search(*this, name, &ComponentInfo::inputs, "input", error);
  return info == nullptr ? InputHandle() : InputHandle(*component, *info);
}

std::string InputHandle::set(const InputValue& value) const {
  if (std::holds_alternative<Vec3>(value) != info_->is_vector)
    return "'" + info_->name + "' takes " + (info_->is_vector ? "three numbers" : "one number");
  const auto admissible = [this](Real x) { return std::isfinite(x) && info_->range.contains(x); };
  const auto refuse = [this](Real x) {
    return "'" + info_->name + "' cannot be " + format_real(x) +
           (std::isfinite(x) ? "; expected " + format_real(info_->range.low) + " to " +
                                   format_real(info_->range.high)
                             : "; expected a finite number");
  };
  if (const Real* x = std::get_if<Real>(&value)) {
    if (!admissible(*x)) return refuse(*x);
  } else {
    for (const Real entry : std::get<Vec3>(value))
      if (!admissible(entry)) return refuse(entry);
  }
  info_->write(*component_, value);
  return {};
}

}  // namespace sutura
