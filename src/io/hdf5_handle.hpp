#pragma once
// Owners of HDF5's handles, and its errors as exceptions.

#include <hdf5.h>

#include <string>
#include <utility>

#include "whirl/core/error.hpp"
#include "whirl/io/record.hpp"

namespace whirl::io {

// Innermost HDF5 message of the failure in flight.
inline std::string reason() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_DOWNWARD,
      [](unsigned, const H5E_error2_t* e, void* out) -> herr_t {
        if (e->desc && *e->desc) *static_cast<std::string*>(out) = e->desc;
        return 0;
      },
      &text);
  return text.empty() ? "HDF5 failed" : text;
}

inline void check(herr_t code) {
  if (code < 0) throw core::Error(reason());
}

// HDF5 prints its errors by default; ours travel as exceptions.
class Quiet {
public:
  Quiet() {
    H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  }
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;
  ~Quiet() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

template <herr_t (*Close)(hid_t)>
class Id {
public:
  Id(hid_t id) : id_(id) {
    if (id < 0) throw core::Error(reason());
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  ~Id() {
    if (id_ >= 0) Close(id_);
  }
  operator hid_t() const { return id_; }
  // Closes at once, as the last writing of a file may fail.
  void close() { check(Close(std::exchange(id_, -1))); }

private:
  hid_t id_;
};

using File = Id<H5Fclose>;
using GroupId = Id<H5Gclose>;
using Data = Id<H5Dclose>;
using Attr = Id<H5Aclose>;
using Space = Id<H5Sclose>;
using Type = Id<H5Tclose>;
using List = Id<H5Pclose>;

// Locks fail on some network file systems, and an atomic rename needs none.
inline hid_t unlocked() {
  const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
  if (list >= 0) H5Pset_file_locking(list, false, true);
  return list;
}

// Chooses some rows of a dataset in the file.
void select_rows(hid_t space, std::size_t begin, std::size_t rows);

// The bytes of a file with `root`. Shared datasets are in it without values or room for them.
//
// It is made in memory: where the disk is full, HDF5 cannot close a file, and ends the process with a fault when it
// tries again at exit.
[[nodiscard]] std::string image_of(const Group& root);

}  // namespace whirl::io
