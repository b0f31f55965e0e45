/* A host in C: steps a scene, reads a force, saves the state.
 *
 *   stitch SCENE STEPS OUTPUT.NAME FOLDER     for example /grasper.force */
#include <stdio.h>
#include <stdlib.h>

#include "sutura/sutura.h"

/* Ends the program with the status of a call that failed, as the command would. */
static void need(sutura_status status) {
  if (status == SUTURA_OK) return;
  fprintf(stderr, "%s\n", sutura_error());
  exit(status);
}

/* What is worth knowing of a step. */
static void show(void* user, int32_t severity, const char* text) {
  (void)user;
  if (severity != SUTURA_NOTE) fprintf(stderr, "%s\n", text);
}

int main(int argc, char** argv) {
  sutura_options options = {.struct_size = sizeof options, .api = SUTURA_API};
  sutura_report report = {.struct_size = sizeof report};
  sutura_value about = {.struct_size = sizeof about};
  sutura_simulation simulation;
  sutura_output output;
  double force[3], largest = 0;
  char state[4096];

  if (argc != 5 || sutura_api() != SUTURA_API) return SUTURA_MISUSE;
  options.output = argv[4];
  options.message = show;
  need(sutura_load(argv[1], &options, &simulation));
  need(sutura_find_output(simulation, argv[3], &output));
  need(sutura_describe_output(output, &about));
  if (about.size != 3) return SUTURA_MISUSE;

  need(sutura_start_recording(simulation));
  for (long i = atol(argv[2]); i > 0; --i) {
    need(sutura_step(simulation, 1));
    need(sutura_get_output(output, force, 3));
    for (int k = 0; k < 3; ++k)
      if (force[k] > largest || -force[k] > largest) largest = force[k] > 0 ? force[k] : -force[k];
  }
  need(sutura_get_report(simulation, &report));
  snprintf(state, sizeof state, "%s/host.sutura", argv[4]);
  need(sutura_save_file(simulation, state));
  need(sutura_finish_recording(simulation));
  printf("%lld steps, %g s simulated, %s up to %.17g %s\n", (long long)report.step, report.time,
         argv[3], largest, about.unit);
  need(sutura_destroy(simulation));
  return 0;
}
