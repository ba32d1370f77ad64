// SPDX-License-Identifier: Apache-2.0
#pragma once
// Inside the two sources that include mpi.h: its return codes as exceptions.

// The deprecated C++ bindings would need a library of their own.
#define OMPI_SKIP_MPICXX 1
#include <mpi.h>

#include <string>

#include "common/base/result.h"

namespace goldthread {

inline void check_mpi(int code, const char* call) {
  if (code == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(code, text, &length);
  throw FatalError({.where = call,
                    .what = std::string(text, static_cast<std::size_t>(length)),
                    .mend = "check the MPI installation and the network between the hosts",
                    .status = ExitStatus::kClusterFailed});
}

}  // namespace goldthread
