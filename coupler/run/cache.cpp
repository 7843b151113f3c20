#include "coupler/run/cache.hpp"

#include <cstdio>

namespace gabion::coupler {

Cache::Cache() {
  const char* own = std::getenv("GABION_CACHE");
  const char* xdg = std::getenv("XDG_CACHE_HOME");
  const char* home = std::getenv("HOME");
  if (own && *own)
    folder_ = own;
  else if (xdg && *xdg)
    folder_ = std::filesystem::path(xdg) / "gabion";
  else
    folder_ = std::filesystem::path(home && *home ? home : ".") / ".cache" / "gabion";
}

std::filesystem::path Cache::file(const std::string& kind, std::uint64_t key) const {
  char name[32];
  std::snprintf(name, sizeof name, "%016llx", static_cast<unsigned long long>(key));
  return folder_ / (kind + "-" + name + ".bin");
}

}  // namespace gabion::coupler
