/* Sutura for C and for every language that can call C. C99.
 *
 * A simulation, an input, an output, a body and a tool are named by handles: numbers that are never
 * used twice. Handles of what a simulation has end with the simulation. A handle that is wrong (of
 * something destroyed, of another kind, made up) is an error and never a crash.
 *
 * Every function that can fail returns a status, SUTURA_OK or what went wrong; sutura_error then
 * has the sentence. A call that fails changes nothing, unless it says so. Nothing is thrown,
 * nothing is printed.
 *
 * Workers (threads of the host): every function may be called by any of them at any time. One
 * simulation answers one call at a time; a second call meanwhile is not made to wait but returns
 * SUTURA_BUSY. Different simulations work side by side and give the bits that each gives alone.
 *
 * The host's process is left as it is: locale, rounding mode, number of BLAS threads. Results do
 * not depend on them, if the number of BLAS threads is not set while a call is at work.
 *
 * Units are SI throughout. Text is UTF-8 and ends with 0. */
#ifndef SUTURA_SUTURA_H
#define SUTURA_SUTURA_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define SUTURA_C __attribute__((visibility("default")))
#else
#define SUTURA_C
#endif

/* Version of this interface. It changes when a program must be compiled anew; structs may grow at
 * their end without, which is why each begins with its size as the caller knows it. */
#define SUTURA_API 1

typedef uint64_t sutura_simulation;
typedef uint64_t sutura_input;
typedef uint64_t sutura_output;
typedef uint64_t sutura_body;
typedef uint64_t sutura_tool;

typedef int32_t sutura_status;
/* Those that the command has too are its exit codes. */
enum {
  SUTURA_OK = 0,
  SUTURA_MISUSE = 1,     /* the call itself is wrong: a handle, a null pointer, a size, a value */
  SUTURA_BAD_SCENE = 2,  /* the scene is wrong */
  SUTURA_BAD_FILE = 3,   /* a file is missing, wrong, or cannot be written; a state does not fit */
  SUTURA_DIVERGED = 4,   /* the state is no longer finite */
  SUTURA_BAD_PLUGIN = 6, /* a plugin is missing or does not fit */
  SUTURA_BUSY = 7,       /* another call on the same simulation has not returned yet */
  SUTURA_NO_MEMORY = 8,  /* there is not enough of it */
  SUTURA_INTERNAL = 70   /* a fault of Sutura or of a plugin: please report it */
};

/* --- The library ----------------------------------------------------------------------------- */

/* SUTURA_API of the library. To be compared with that of the header. */
SUTURA_C uint32_t sutura_api(void);
/* "0.1.0". Lives as long as the library. */
SUTURA_C const char* sutura_version(void);
/* What went wrong in the last call of this worker that failed: a sentence; "" if none has. Valid
 * until the next call of this worker that fails. */
SUTURA_C const char* sutura_error(void);

enum { SUTURA_NOTE = 0, SUTURA_WARNING = 1, SUTURA_ERROR = 2 };

/* One thing that loading has found. Texts are valid until this worker loads again. */
typedef struct sutura_diagnostic {
  uint32_t struct_size; /* in: sizeof(sutura_diagnostic) */
  int32_t severity;     /* SUTURA_WARNING or SUTURA_ERROR */
  sutura_status status; /* what it makes of the load */
  int32_t line;         /* from 1; 0: the whole file */
  const char* file;
  const char* path;    /* of the component, "/skin/tissue", or "" */
  const char* message; /* one sentence */
} sutura_diagnostic;

/* Number of things that the last load of this worker has found, warnings included. */
SUTURA_C size_t sutura_diagnostic_count(void);
/* The one with this number, from 0. */
SUTURA_C sutura_status sutura_diagnostic_at(size_t number, sutura_diagnostic* diagnostic);

/* --- A simulation, from its beginning to its end ---------------------------------------------- */

/* What is worth knowing, while a call that loads or steps is at work, by the worker that made the
 * call. May call functions of other simulations; the same one answers SUTURA_BUSY. Must return.
 * `text` is valid until then. */
typedef void (*sutura_message)(void* user, int32_t severity, const char* text);

/* Work that need not be done within a step: a tissue's next factor. `data` is what the library has
 * handed over with it; of anything else nothing happens. */
typedef void (*sutura_job)(void* data);
/* Has a pool of the host call job(data), soon and on any worker of it; during this call too, if
 * the pool likes. Called by whoever steps, loads or restores; several simulations may do so at
 * once. Must not call the library otherwise. The pool may come late, or never: a factor that a step
 * must have is made in the step, one with lag "free" is older then. After sutura_destroy, and a
 * second time, job(data) does nothing. */
typedef void (*sutura_enqueue)(void* pool, sutura_job job, void* data);

/* How to load. All zero but the first two members: as the command does. */
typedef struct sutura_options {
  uint32_t struct_size;                  /* in: sizeof(sutura_options) */
  uint32_t api;                          /* in: SUTURA_API */
  const char* const* plugin_directories; /* searched before the others */
  size_t plugin_directory_count;
  const char* const* settings; /* in pairs, as --set: "/skin/tissue.young", "30 kPa" */
  size_t setting_count;        /* pairs */
  const char* output;          /* folder of the recorders; null: out/NAME, of the scene */
  int32_t allow_outside;       /* 1: recorders may write outside of it */
  sutura_message message;      /* null: none */
  void* user;                  /* handed to `message` */
  sutura_enqueue enqueue;      /* null: each tissue that needs one starts a worker of its own */
  void* pool;                  /* handed to `enqueue` */
} sutura_options;

/* Reads a scene with its plugins and files and makes it ready for its first step. `options` may be
 * null. Returns the status of the first error; sutura_diagnostic_at has all of them. */
SUTURA_C sutura_status sutura_load(const char* file, const sutura_options* options,
                                   sutura_simulation* simulation);
/* The same from `size` bytes of XML. `name` stands for the file in messages (null: "scene"); files
 * that the scene names are looked for in `directory` (null: the current one). */
SUTURA_C sutura_status sutura_load_text(const char* text, size_t size, const char* name,
                                        const char* directory, const sutura_options* options,
                                        sutura_simulation* simulation);
/* Ends the simulation and all its handles. A recording that is under way is finished. */
SUTURA_C sutura_status sutura_destroy(sutura_simulation simulation);

/* Takes up to `count` time steps. A step that misses its tolerances is said to the message function
 * and counted in the report, and the next one is taken: it is less accurate than the scene asks, as
 * exit code 5 of the command says. Stops at the first one that goes wrong: SUTURA_DIVERGED,
 * SUTURA_BAD_FILE if a recorder cannot write (the step is done), or what a component said that
 * failed. After any of these but SUTURA_BAD_FILE no further step is taken until sutura_restore or
 * sutura_reset. */
SUTURA_C sutura_status sutura_step(sutura_simulation simulation, size_t count);

/* The last step. */
typedef struct sutura_report {
  uint32_t struct_size; /* in: sizeof(sutura_report) */
  int32_t solved;       /* 1: every tolerance of the scene has been met */
  int64_t step;         /* steps taken since the beginning of the scene */
  double time;          /* s, at its end */
  double dt;            /* s, of one step */
  double duration;      /* s, what the scene gives; 0: nothing */
  int64_t rows;         /* of constraints */
  int64_t passes;       /* linearisations, all parts of the step together */
  int64_t parts;        /* into how many the step was divided; between two events, at its finest */
  int64_t events;       /* what cannot be undone: punctures, breaking away */
  int64_t faults;   /* reasons not to trust the step; their sentences go to the message function */
  double imbalance; /* of momentum, relative to the forces at work; the worst over the bodies */
  double violation; /* m, the largest distance of a constraint from its law */
  double seconds;   /* wall time */
  int64_t missed;   /* steps that missed their tolerances or had faults, since loading,
                       sutura_restore or sutura_reset: also those of a count of steps before the
                       last */
} sutura_report;

/* Of the last step; of the beginning, or of the state, if there has been none since. */
SUTURA_C sutura_status sutura_get_report(sutura_simulation simulation, sutura_report* report);

/* The scene as XML that loads to the same scene. Valid until the next call of this function for
 * this simulation. */
SUTURA_C sutura_status sutura_write_scene(sutura_simulation simulation, const char** xml);

/* --- State ------------------------------------------------------------------------------------ */

/* Everything that the next steps depend on, inputs that have been set included. The bytes belong to
 * the simulation and are valid until its next sutura_save. */
SUTURA_C sutura_status sutura_save(sutura_simulation simulation, const void** data, size_t* size);
/* Goes back, or on, to a state of the same scene: the steps from there are the same to the bit.
 * SUTURA_BAD_FILE if it is damaged, of another scene or of another build. Not while recording. */
SUTURA_C sutura_status sutura_restore(sutura_simulation simulation, const void* data, size_t size);
/* sutura_save to a file, which the command can go on from (--resume). Makes its folder; replaces a
 * file that is there, whole or not at all. SUTURA_BAD_FILE if it cannot, or if it is no file. */
SUTURA_C sutura_status sutura_save_file(sutura_simulation simulation, const char* file);
/* sutura_restore from a file: of sutura_save_file, or of the command (--checkpoint-every). */
SUTURA_C sutura_status sutura_restore_file(sutura_simulation simulation, const char* file);
/* Back to before the first step. Not while recording. */
SUTURA_C sutura_status sutura_reset(sutura_simulation simulation);

/* --- Recording -------------------------------------------------------------------------------- */

/* Opens the files of the recorders of the scene (probes, ParaView) in the folder for output, which
 * one simulation owns at a time, and records the present state; steps are recorded from then on. */
SUTURA_C sutura_status sutura_start_recording(sutura_simulation simulation);
/* The same after sutura_restore: the files are cut back to the step of the state and go on. */
SUTURA_C sutura_status sutura_resume_recording(sutura_simulation simulation);
/* Completes and closes the files. */
SUTURA_C sutura_status sutura_finish_recording(sutura_simulation simulation);

/* --- Components ------------------------------------------------------------------------------- */

/* What the scene is made of, in the order of the scene. Texts live as long as the simulation. */
typedef struct sutura_component {
  uint32_t struct_size; /* in: sizeof(sutura_component) */
  int32_t line;         /* in the file of the scene */
  const char* path;     /* "/skin/tissue" */
  const char* type;     /* "Tissue" */
  const char* plugin;   /* "tissue"; "core" without one */
  const char* summary;  /* one or two sentences */
} sutura_component;

/* Number of components, 1 or more. */
SUTURA_C sutura_status sutura_component_count(sutura_simulation simulation, size_t* count);
/* The one with this number, from 0. SUTURA_MISUSE if there is none. */
SUTURA_C sutura_status sutura_component_at(sutura_simulation simulation, size_t number,
                                           sutura_component* component);

/* --- Inputs and outputs: `sutura describe COMPONENT` lists them --------------------------------
 */

/* An input or an output. Texts live as long as the simulation. */
typedef struct sutura_value {
  uint32_t struct_size; /* in: sizeof(sutura_value) */
  uint32_t size;        /* numbers: 1 or 3; 0: a text */
  const char* path;     /* of its component, "/track" */
  const char* name;     /* "position" */
  const char* unit;     /* SI: "m" */
  const char* doc;      /* one sentence */
  double low, high;     /* admissible, of each number; infinite where there is no limit */
} sutura_value;

/* By the path of the component, a dot and the name: "/track.position". SUTURA_MISUSE, and the
 * nearest name, if there is none. */
SUTURA_C sutura_status sutura_find_input(sutura_simulation simulation, const char* name,
                                         sutura_input* input);
/* Number of inputs of all components. */
SUTURA_C sutura_status sutura_input_count(sutura_simulation simulation, size_t* count);
/* The one with this number, from 0, in the order of the scene. */
SUTURA_C sutura_status sutura_input_at(sutura_simulation simulation, size_t number,
                                       sutura_input* input);
/* Name, unit, range, how many numbers, a sentence. */
SUTURA_C sutura_status sutura_describe_input(sutura_input input, sutura_value* value);
/* Holds from the next step on, until it is set anew. `values`: `count` numbers in the unit of the
 * input, `count` its size, 1 or 3. SUTURA_MISUSE for a value that is not finite or out of range. */
SUTURA_C sutura_status sutura_set_input(sutura_input input, const double* values, size_t count);

/* As sutura_find_input: "/grasper.force". */
SUTURA_C sutura_status sutura_find_output(sutura_simulation simulation, const char* name,
                                          sutura_output* output);
/* Number of outputs of all components. */
SUTURA_C sutura_status sutura_output_count(sutura_simulation simulation, size_t* count);
/* The one with this number, from 0, in the order of the scene. */
SUTURA_C sutura_status sutura_output_at(sutura_simulation simulation, size_t number,
                                        sutura_output* output);
/* Name, unit, how many numbers, a sentence; the range is infinite. */
SUTURA_C sutura_status sutura_describe_output(sutura_output output, sutura_value* value);
/* At the end of the last step. `values` takes `count` numbers in the unit of the output, `count`
 * its size, 1 or 3. SUTURA_MISUSE for an output that is a text. */
SUTURA_C sutura_status sutura_get_output(sutura_output output, double* values, size_t count);
/* Of an output that is a text. Valid until the next call of this function for this simulation. */
SUTURA_C sutura_status sutura_get_text(sutura_output output, const char** text);

/* --- Bodies: threads and tissues, for drawing --------------------------------------------------
 */

/* By its path: "/skin/tissue". SUTURA_MISUSE, and the nearest name, if there is none. */
SUTURA_C sutura_status sutura_find_body(sutura_simulation simulation, const char* path,
                                        sutura_body* body);
/* Number of bodies. */
SUTURA_C sutura_status sutura_body_count(sutura_simulation simulation, size_t* count);
/* The one with this number, from 0, in the order of the scene. */
SUTURA_C sutura_status sutura_body_at(sutura_simulation simulation, size_t number,
                                      sutura_body* body);

/* A body at the end of the last step. Pointers are valid until the next call that steps, restores,
 * resets or destroys its simulation. */
typedef struct sutura_geometry {
  uint32_t struct_size; /* in: sizeof(sutura_geometry) */
  uint32_t corners;     /* of a cell: 2, a beam; 4, a tetrahedron */
  uint64_t topology;    /* another number whenever cells or the number of points are others */
  const char* path;     /* of the body */
  size_t point_count;
  const double* points; /* point_count x 3, m */
  size_t cell_count;
  const int64_t* cells; /* cell_count x corners, numbers of points from 0 */
  size_t field_count;   /* for sutura_get_field */
} sutura_geometry;

/* Where it is. The first call after a step copies it: points x 24 bytes and more for fields. */
SUTURA_C sutura_status sutura_get_geometry(sutura_body body, sutura_geometry* geometry);

/* What a body knows of each of its points or cells; valid as its geometry is. */
typedef struct sutura_field {
  uint32_t struct_size; /* in: sizeof(sutura_field) */
  int32_t on_cells;     /* 1: one entry per cell; 0: per point */
  const char* name;     /* with unit: "velocity [m/s]" */
  size_t count;         /* entries */
  size_t components;    /* numbers per entry */
  const double* values; /* count x components */
} sutura_field;

/* The one with this number, from 0 to field_count - 1 of the geometry. */
SUTURA_C sutura_status sutura_get_field(sutura_body body, size_t number, sutura_field* field);

/* --- Tools: tracks that a host may move ---------------------------------------------------------
 */

/* Poses are seven numbers: a position (m) and a unit quaternion w x y z. They are motions of space
 * by which the tool is away from where it was modelled: x becomes position + rotation x. */

/* By its path: "/track". SUTURA_MISUSE, and the nearest name, if there is none. */
SUTURA_C sutura_status sutura_find_tool(sutura_simulation simulation, const char* path,
                                        sutura_tool* tool);
/* Number of tools. */
SUTURA_C sutura_status sutura_tool_count(sutura_simulation simulation, size_t* count);
/* The one with this number, from 0, in the order of the scene. */
SUTURA_C sutura_status sutura_tool_at(sutura_simulation simulation, size_t number,
                                      sutura_tool* tool);
/* Seven numbers: where it is at the end of the last step. */
SUTURA_C sutura_status sutura_get_pose(sutura_tool tool, double pose[7]);
/* Where the tool is at the end of the next step, and of those after it; its key frames count no
 * more. The quaternion may be off unit length by 1e-3 and is made unit. SUTURA_MISUSE if it is off
 * by more, or if a number is not finite. */
SUTURA_C sutura_status sutura_set_pose(sutura_tool tool, const double pose[7]);

#ifdef __cplusplus
}
#endif

#endif /* SUTURA_SUTURA_H */
