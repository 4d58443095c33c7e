#pragma once

namespace lucarne::log {

/// Drops all messages (log.h), for one of several processes that would all say the same.
void set_silent(bool silent);

}  // namespace lucarne::log
