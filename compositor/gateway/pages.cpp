// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/pages.h"

#include <algorithm>
#include <utility>

namespace goldthread {
namespace {

constexpr std::pair<std::string_view, std::string_view> kMimeTypes[] = {
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".mjs", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".json", "application/json"},
    {".map", "application/json"},
    {".wasm", "application/wasm"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".jpg", "image/jpeg"},
    {".ico", "image/x-icon"},
    {".woff2", "font/woff2"},
    {".txt", "text/plain; charset=utf-8"}};

}  // namespace

const EmbeddedPage* find_page(std::string_view path) {
  if (path == "/") path = "/index.html";
  const auto pages = embedded_pages();
  const auto found = std::lower_bound(
      pages.begin(), pages.end(), path,
      [](const EmbeddedPage& page, std::string_view wanted) { return page.path < wanted; });
  return found != pages.end() && found->path == path ? &*found : nullptr;
}

std::string_view mime_type(std::string_view path) {
  for (const auto& [extension, type] : kMimeTypes) {
    if (path.ends_with(extension)) return type;
  }
  return "application/octet-stream";
}

bool is_immutable(std::string_view path) { return path.starts_with("/assets/"); }

}  // namespace goldthread
