#!/bin/sh
# The OpenCL benchmark on a machine that has a device but neither CMake nor the libraries of the rest: g++, Eigen and
# OpenCL's headers and loader are enough. With CHOLMOD and METIS, conjugate gradients are measured too.
#   tests/bench/opencl_alone.sh OUT_DIR [PART OF A DEVICE'S NAME [MOST NODES [PART]]]
# PART: sweeps, gradients, step, kernels, threads or accuracy; left out, all of them.
# CPPFLAGS and LDFLAGS say where things are that are not in their usual places.
set -eu
cd "$(dirname "$0")/../.."
mkdir -p "$1/objects"
objects=$1/objects

{
  echo 'namespace sutura::opencl::programs {'
  for name in laws sweep solves gradients elements compliance direct_step batch batch_solve; do
    printf 'extern const char* const %s;\nconst char* const %s = R"cl(' $name $name
    cat plugins/opencl/$name.cl
    echo ')cl";'
  done
  echo '}'
} >"$objects/programs.cpp"

flags="-std=c++20 -O3 -march=native -DNDEBUG -ffp-contract=off -DEIGEN_MAX_ALIGN_BYTES=32 -Iinclude -Isrc -Itests
  -Iplugins/opencl -Iplugins/tissue -Iplugins/thread -isystem /usr/include/eigen3 -isystem /usr/include/suitesparse ${CPPFLAGS:-}"
libraries=-lOpenCL
if echo '#include <cholmod.h>' | g++ $flags -E -x c++ - >/dev/null 2>&1; then
  flags="$flags -DSUTURA_WITH_CHOLMOD=1"
  libraries="$libraries -lcholmod -lmetis -lopenblas"
fi

tissue="block_matrix pcg recent_solutions factor factor_cholmod factor_eigen factor_order dense_inverse corotational_t4 smoothed_t4
  node_rotations rotation twist_stiffness async_solver async_factor async_state compliance
  growing_compliance held_nodes assembly tissue_step"
thread="block_tridiagonal chain_motion element rod rod_guess rod_tangent stretches viscosity"
{
  ls tests/bench/opencl*.cpp src/solve/*.cpp src/base/*.cpp "$objects/programs.cpp"
  ls plugins/opencl/*.cpp | grep -v -e /plugin -e /opencl_device -e /thread_batch
  for name in $thread; do echo plugins/thread/$name.cpp; done
  for name in $tissue; do echo plugins/tissue/$name.cpp; done
} | while read -r source; do  # two of them have the same name
  echo "g++ $(echo $flags) -c $source -o $objects/$(echo "$source" | tr / _).o"
done |
  xargs -P "$(nproc)" -I COMMAND sh -c COMMAND
g++ "$objects"/*.o ${LDFLAGS:-} $libraries -pthread -o "$1/sutura_bench_opencl"
exec "$1/sutura_bench_opencl" "$@"
