#include "device.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace sutura::opencl {
namespace {

std::string meaning(cl_int code) {
  switch (code) {
    case CL_DEVICE_NOT_AVAILABLE:
      return "the device is not available";
    case CL_MEM_OBJECT_ALLOCATION_FAILURE:
      return "no memory left on the device";
    case CL_OUT_OF_RESOURCES:
      return "out of resources on the device (memory, registers, or the device is lost)";
    case CL_OUT_OF_HOST_MEMORY:
      return "no memory left";
    case CL_INVALID_BUFFER_SIZE:
      return "the device does not allow memory of this size in one piece";
    case CL_INVALID_COMMAND_QUEUE:
    case CL_INVALID_CONTEXT:
      return "the device is lost";
    case -1001:
      return "no OpenCL driver is installed";
    default:
      return "the driver gives no reason";
  }
}

struct Found {
  cl_device_id id;
  std::string name, platform;
  cl_device_type type;
};

template <class Get>
std::string text_of(const Get& get) {
  std::size_t size = 0;
  if (get(0, nullptr, &size) != CL_SUCCESS || size == 0) return {};
  std::string out(size, ' ');
  get(size, out.data(), nullptr);
  out.resize(out.find('\0') == std::string::npos ? size : out.find('\0'));
  while (!out.empty() && out.back() == ' ') out.pop_back();
  return out;
}

template <class T>
T number_of(cl_device_id id, cl_device_info what) {
  T value{};
  clGetDeviceInfo(id, what, sizeof(value), &value, nullptr);
  return value;
}

std::string text_of(cl_device_id id, cl_device_info what) {
  return text_of([&](std::size_t size, void* value, std::size_t* needed) {
    return clGetDeviceInfo(id, what, size, value, needed);
  });
}

std::vector<Found> find_devices() {
  cl_uint count = 0;
  if (clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) return {};
  std::vector<cl_platform_id> platforms(count);
  clGetPlatformIDs(count, platforms.data(), nullptr);
  std::vector<Found> out;
  for (const cl_platform_id platform : platforms) {
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS) continue;
    std::vector<cl_device_id> ids(count);
    clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, ids.data(), nullptr);
    const std::string where = text_of([&](std::size_t size, void* value, std::size_t* needed) {
      return clGetPlatformInfo(platform, CL_PLATFORM_NAME, size, value, needed);
    });
    for (const cl_device_id id : ids)
      out.push_back(
          {id, text_of(id, CL_DEVICE_NAME), where, number_of<cl_device_type>(id, CL_DEVICE_TYPE)});
  }
  return out;
}

const char* word(cl_device_type type) {
  if (type & CL_DEVICE_TYPE_GPU) return "gpu";
  if (type & CL_DEVICE_TYPE_CPU) return "cpu";
  return "accelerator";
}

bool has_double(cl_device_id id) {
  return number_of<cl_device_fp_config>(id, CL_DEVICE_DOUBLE_FP_CONFIG) != 0;
}

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

bool fits(const Found& found, const DeviceChoice& choice) {
  static const char* const words[] = {"", "gpu", "cpu", "accelerator"};
  const std::string wanted = words[static_cast<int>(choice.type)];
  return (wanted.empty() || wanted == word(found.type)) &&
         lower(found.name).find(lower(choice.name)) != std::string::npos;
}

constexpr const char* no_device =
    "no OpenCL device on this machine: neither a driver of a GPU nor pocl (Debian: "
    "pocl-opencl-icd) is installed";

}  // namespace

std::string list_devices() {
  std::string out;
  for (const Found& f : find_devices()) {
    const auto mebibytes = number_of<cl_ulong>(f.id, CL_DEVICE_GLOBAL_MEM_SIZE) >> 20;
    out += "opencl " + std::string(word(f.type)) + "  \"" + f.name + "\"  " +
           std::to_string(number_of<cl_uint>(f.id, CL_DEVICE_MAX_COMPUTE_UNITS)) + " units, " +
           std::to_string(mebibytes) + " MiB, " + (has_double(f.id) ? "double" : "single") +
           " precision, " + text_of(f.id, CL_DEVICE_VERSION) + " (" + f.platform + ")\n";
  }
  return out.empty() ? std::string(no_device) + "\n" : out;
}

Device::Device(const DeviceChoice& choice) : timed_(choice.timed) {
  const std::vector<Found> all = find_devices();
  if (all.empty()) throw DeviceError(no_device);
  std::vector<Found> fitting;
  for (const Found& f : all)
    if (fits(f, choice)) fitting.push_back(f);
  if (choice.index >= static_cast<Index>(fitting.size())) {
    std::string there;
    for (const Found& f : all)
      there += (there.empty() ? "" : ", ") + ("\"" + f.name + "\" (" + word(f.type) + ")");
    throw DeviceError(fitting.empty()
                          ? "no OpenCL device of this name and type; there is " + there
                          : "index " + std::to_string(choice.index) + ": only " +
                                std::to_string(fitting.size()) +
                                " OpenCL devices of this name and type; there is " + there);
  }
  const Found& found = fitting[static_cast<std::size_t>(choice.index)];
  id_ = found.id;
  name_ = found.name;
  has_double_ = opencl::has_double(id_);
  largest_group_ = number_of<std::size_t>(id_, CL_DEVICE_MAX_WORK_GROUP_SIZE);
  cl_int code = CL_SUCCESS;
  context_ = clCreateContext(nullptr, 1, &id_, nullptr, nullptr, &code);
  check(code, "opening it");
  queue_ = clCreateCommandQueue(context_, id_, timed_ ? CL_QUEUE_PROFILING_ENABLE : 0, &code);
  if (code != CL_SUCCESS) clReleaseContext(context_);
  check(code, "opening its queue");
}

Device::~Device() {
  for (const Launch& l : launches_) clReleaseEvent(l.event);
  clReleaseCommandQueue(queue_);
  clReleaseContext(context_);
}

void Device::check(cl_int code, const char* what, const std::string& which) const {
  if (lost_) code = CL_DEVICE_NOT_AVAILABLE;
  if (code != CL_SUCCESS)
    throw DeviceError("OpenCL device \"" + name_ + "\", " + what +
                      (which.empty() ? "" : " " + which) + ": " + meaning(code) + " (code " +
                      std::to_string(code) + ")");
}

void Device::finish() const {
  check(clFinish(queue_), "waiting for it");
}

void Device::drain() const noexcept {
  clFinish(queue_);
}

std::vector<KernelTime> Device::take_times() {
  finish();
  std::vector<KernelTime> out;
  for (const Launch& l : launches_) {
    cl_ulong begin = 0, end = 0;
    clGetEventProfilingInfo(l.event, CL_PROFILING_COMMAND_START, sizeof(begin), &begin, nullptr);
    clGetEventProfilingInfo(l.event, CL_PROFILING_COMMAND_END, sizeof(end), &end, nullptr);
    clReleaseEvent(l.event);
    auto k = std::ranges::find(out, l.kernel, &KernelTime::name);
    if (k == out.end()) k = out.insert(k, {l.kernel});
    ++k->launches;
    k->us += 1e-3 * static_cast<double>(end - begin);
  }
  launches_.clear();
  std::ranges::sort(out, std::ranges::greater{}, &KernelTime::us);
  return out;
}

cl_program Device::build(const std::string& source, const std::string& options) const {
  const char* text = source.c_str();
  const std::size_t length = source.size();
  cl_int code = CL_SUCCESS;
  const cl_program program = clCreateProgramWithSource(context_, 1, &text, &length, &code);
  check(code, "reading a program");
  code = clBuildProgram(program, 1, &id_, options.c_str(), nullptr, nullptr);
  if (code == CL_SUCCESS) return program;
  const std::string log = text_of([&](std::size_t size, void* value, std::size_t* needed) {
    return clGetProgramBuildInfo(program, id_, CL_PROGRAM_BUILD_LOG, size, value, needed);
  });
  clReleaseProgram(program);
  throw DeviceError("OpenCL device \"" + name_ + "\" does not compile a program (" + options +
                    "), code " + std::to_string(code) + ":\n" + log);
}

}  // namespace sutura::opencl
