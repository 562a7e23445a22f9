/// An EGL context without a display. Part of preview_egl.cpp, which alone may include it.
#pragma once

#include <cstring>
#include <initializer_list>
#include <string>

#include <dlfcn.h>
#include <epoxy/egl.h>
#include <fmt/format.h>

#include "core/base/error.h"

namespace softreel {

inline Error unusable(const std::string& what) {
  return work_error(
      fmt::format("The preview cannot draw: {}.\n"
                  "  Accepted: EGL with OpenGL 3.3, on a GPU or in software. Install libegl1, libgl1 and "
                  "libgl1-mesa-dri, or render with the path tracer instead.",
                  what));
}

inline bool lists(const char* extensions, const char* name) {
  return extensions != nullptr && std::strstr(extensions, name) != nullptr;
}

/// Loads the first of the libraries that can be had; it stays loaded until the program ends, as epoxy's do.
inline void load_one_of(std::initializer_list<const char*> libraries) {
  std::string reasons;
  for (const char* library : libraries) {
    if (dlopen(library, RTLD_LAZY | RTLD_LOCAL) != nullptr) return;
    const char* reason = dlerror();
    reasons += fmt::format("{}{}", reasons.empty() ? "" : "; ", reason != nullptr ? reason : library);
  }
  throw unusable(fmt::format("a library cannot be loaded ({})", reasons));
}

/// A current context that draws into framebuffers only; ends with its scope.
class EglContext {
 public:
  EglContext() {
    // epoxy, which looks for them at the first call of a function of theirs, ends the program where they are missing.
    load_one_of({"libEGL.so.1"});
    load_one_of({"libGL.so.1", "libOpenGL.so.0"});
    open_display();
  }
  ~EglContext() {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);
    eglTerminate(display_);
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() const {
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) != EGL_TRUE)
      throw unusable(fmt::format("its context does not start (EGL error {:#x})", eglGetError()));
  }
  std::string version() const { return fmt::format("EGL {}.{}", major_, minor_); }

 private:
  /// Whether the display gives a context. One that does not is ended; why is kept of the first.
  bool opens(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || eglInitialize(display, &major_, &minor_) != EGL_TRUE) return false;
    if (lists(eglQueryString(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
      context_ = new_context(display);
      if (context_ != EGL_NO_CONTEXT) {
        display_ = display;
        return true;
      }
      // Before the end of the display, which is a success and takes the error with it.
      if (refusal_.empty()) refusal_ = fmt::format("no OpenGL 3.3 context (EGL error {:#x})", eglGetError());
    }
    eglTerminate(display);
    return false;
  }

  static EGLContext new_context(EGLDisplay display) {
    const EGLint wanted[] = {EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
    const EGLint version[] = {
        EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK, 1, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint count = 0;
    if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) return EGL_NO_CONTEXT;
    if (eglChooseConfig(display, wanted, &config, 1, &count) != EGL_TRUE || count < 1) return EGL_NO_CONTEXT;
    return eglCreateContext(display, config, EGL_NO_CONTEXT, version);
  }

  /// Mesa without a window system, else the first device that works; devices in software are listed too.
  void open_display() {
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (!lists(extensions, "EGL_EXT_platform_base")) throw unusable("this EGL knows no platform without a window");
    if (lists(extensions, "EGL_MESA_platform_surfaceless") &&
        opens(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)))
      return;
    if (lists(extensions, "EGL_EXT_device_enumeration") && lists(extensions, "EGL_EXT_platform_device")) {
      EGLDeviceEXT devices[16];
      EGLint count = 0;
      if (eglQueryDevicesEXT(16, devices, &count) != EGL_TRUE) count = 0;
      for (EGLint k = 0; k < count; ++k)
        if (opens(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[k], nullptr))) return;
    }
    throw unusable(refusal_.empty() ? "no EGL device can be opened" : refusal_);
  }

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  EGLint major_ = 0, minor_ = 0;
  std::string refusal_;
};

}  // namespace softreel
