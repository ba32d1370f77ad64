// SPDX-License-Identifier: Apache-2.0
#pragma once
// The page's files, embedded in the program by embed_pages.cmake. Looked up by their exact path
// alone: there is no folder to escape from.

#include <cstddef>
#include <span>
#include <string_view>

namespace goldthread {

struct EmbeddedPage {
  std::string_view path;  ///< as in a URL, from the root: "/index.html"
  std::string_view etag;  ///< quoted, of the content
  std::span<const char> bytes;
};

/// All embedded files, in ascending order of path.
std::span<const EmbeddedPage> embedded_pages();

/// The file for a URL's path ("/" is "/index.html"), or null.
const EmbeddedPage* find_page(std::string_view path);

/// By the file's extension; application/octet-stream if it is unknown.
std::string_view mime_type(std::string_view path);

/// Does the name hold a hash of the content, so that it may be kept for ever?
bool is_immutable(std::string_view path);

}  // namespace goldthread
