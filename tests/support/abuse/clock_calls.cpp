/// The time of day jumps; the monotonic clock, by which a program must measure, stays honest.
#include <ctime>

#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include "tests/support/abuse/abuse.h"

namespace {

timespec time_of_day() {
  timespec now{};
  ::syscall(SYS_clock_gettime, CLOCK_REALTIME, &now);
  if (abuse::has_hostile_clock()) now.tv_sec += abuse::clock_jump();
  return now;
}

}  // namespace

ABUSE_CALL int clock_gettime(clockid_t clock, timespec* time) noexcept {
  if (clock != CLOCK_REALTIME && clock != CLOCK_REALTIME_COARSE)
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  *time = time_of_day();
  return 0;
}

ABUSE_CALL time_t time(time_t* result) noexcept {
  const time_t now = time_of_day().tv_sec;
  if (result != nullptr) *result = now;
  return now;
}

ABUSE_CALL int gettimeofday(timeval* time, void*) noexcept {
  const timespec now = time_of_day();
  *time = {now.tv_sec, now.tv_nsec / 1000};
  return 0;
}

ABUSE_CALL int timespec_get(timespec* time, int base) noexcept {
  *time = time_of_day();
  return base;
}
