#include "whirl/io/hdf5.hpp"

#include <algorithm>

#include "io/atomic_file.hpp"
#include "io/hdf5_handle.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/petsc.hpp"

namespace whirl::io {
namespace {

hid_t utf8() {
  const hid_t t = H5Tcopy(H5T_C_S1);
  if (t >= 0 && (H5Tset_size(t, H5T_VARIABLE) < 0 || H5Tset_cset(t, H5T_CSET_UTF8) < 0)) {
    H5Tclose(t);
    return -1;
  }
  return t;
}

hid_t in_memory() {
  const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
  if (list >= 0) check(H5Pset_fapl_core(list, std::size_t{1} << 20, false));
  return list;
}

hid_t space_of(const Shape& shape) {
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  return extents.empty() ? H5Screate(H5S_SCALAR)
                         : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
}

void write_attribute(hid_t at, const std::string& name, const Attribute& value) {
  const Space scalar(H5Screate(H5S_SCALAR));
  if (const auto* s = std::get_if<std::string>(&value)) {
    const Type type(utf8());
    const Attr a(H5Acreate2(at, name.c_str(), type, scalar, H5P_DEFAULT, H5P_DEFAULT));
    const char* c = s->c_str();
    check(H5Awrite(a, type, &c));
  } else if (const auto* d = std::get_if<double>(&value)) {
    const Attr a(H5Acreate2(at, name.c_str(), H5T_IEEE_F64LE, scalar, H5P_DEFAULT, H5P_DEFAULT));
    check(H5Awrite(a, H5T_NATIVE_DOUBLE, d));
  } else {
    const Attr a(H5Acreate2(at, name.c_str(), H5T_STD_I64LE, scalar, H5P_DEFAULT, H5P_DEFAULT));
    check(H5Awrite(a, H5T_NATIVE_INT64, &std::get<std::int64_t>(value)));
  }
}

// Names along an axis: `labels` of the second one, `labels_2` of the third. An attribute holds 64 kB; longer ones are
// left out.
std::string name_of_labels(std::size_t k) {
  return k == 0 ? "labels" : "labels_" + std::to_string(k + 1);
}

void write_labels(hid_t at, const Dataset& data) {
  for (std::size_t k = 0; k < data.labels.size(); ++k) {
    std::vector<const char*> texts;
    for (const std::string& s : data.labels[k]) texts.push_back(s.c_str());
    const hsize_t n = texts.size();
    if (n == 0 || n > 4000) continue;
    const Space space(H5Screate_simple(1, &n, nullptr));
    const Type type(utf8());
    const Attr a(H5Acreate2(at, name_of_labels(k).c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT));
    check(H5Awrite(a, type, texts.data()));
  }
}

// `n` texts, which `load` reads as the type that it is given.
template <class Load>
std::vector<std::string> read_texts(std::size_t n, const Load& load) {
  const Type memory(utf8());
  std::vector<char*> texts(n, nullptr);
  load(memory, static_cast<void*>(texts.data()));
  std::vector<std::string> out;
  for (char* c : texts) {
    out.emplace_back(c ? c : "");
    H5free_memory(c);
  }
  return out;
}

std::vector<std::vector<std::string>> read_labels(hid_t at) {
  std::vector<std::vector<std::string>> labels;
  for (std::size_t k = 0; k < 2; ++k) {
    if (H5Aexists(at, name_of_labels(k).c_str()) <= 0) continue;
    labels.resize(k);
    const Attr a(H5Aopen(at, name_of_labels(k).c_str(), H5P_DEFAULT));
    const Space space(H5Aget_space(a));
    labels.push_back(read_texts(static_cast<std::size_t>(H5Sget_select_npoints(space)),
                                [&](hid_t type, void* texts) { check(H5Aread(a, type, texts)); }));
  }
  return labels;
}

// How a file says that a dataset is shared: it is never filled, as ranks write their rows into the room it is given.
constexpr H5D_fill_time_t of_rows = H5D_FILL_TIME_NEVER;

void write_dataset(hid_t at, const std::string& name, const Dataset& data) {
  const Space space(space_of(data.whole_shape()));
  const List how(H5Pcreate(H5P_DATASET_CREATE));
  if (data.share) check(H5Pset_fill_time(how, of_rows));
  const auto store = [&](hid_t file_type, hid_t memory_type, const void* values) {
    const Data d(H5Dcreate2(at, name.c_str(), file_type, space, H5P_DEFAULT, how, H5P_DEFAULT));
    if (data.size() > 0 && !data.share) check(H5Dwrite(d, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
    if (!data.unit.empty()) write_attribute(d, "unit", data.unit);
    if (!data.description.empty()) write_attribute(d, "description", data.description);
    write_labels(d, data);
  };
  if (const auto* x = std::get_if<std::vector<double>>(&data.values)) {
    store(H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, x->data());
  } else if (const auto* i = std::get_if<std::vector<std::int64_t>>(&data.values)) {
    store(H5T_STD_I64LE, H5T_NATIVE_INT64, i->data());
  } else {
    std::vector<const char*> texts;
    for (const std::string& s : std::get<std::vector<std::string>>(data.values)) texts.push_back(s.c_str());
    const Type type(utf8());
    store(type, type, texts.data());
  }
}

// Callbacks only collect names, so that no exception crosses HDF5's frames.
template <class Info>
herr_t collect(hid_t /*at*/, const char* name, const Info* /*info*/, void* out) {
  static_cast<std::vector<std::string>*>(out)->emplace_back(name);
  return 0;
}
std::vector<std::string> names_of_attributes(hid_t at) {
  std::vector<std::string> names;
  check(H5Aiterate2(at, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect<H5A_info_t>, &names));
  return names;
}
std::vector<std::string> names_of_links(hid_t at) {
  std::vector<std::string> names;
  check(H5Literate(at, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect<H5L_info_t>, &names));
  return names;
}

Attribute read_attribute(hid_t at, const char* name) {
  const Attr a(H5Aopen(at, name, H5P_DEFAULT));
  const Type type(H5Aget_type(a));
  double real = 0;
  std::int64_t integer = 0;
  switch (H5Tget_class(type)) {
    case H5T_STRING:
      return read_texts(1, [&](hid_t memory, void* text) { check(H5Aread(a, memory, text)); }).front();
    case H5T_FLOAT:
      check(H5Aread(a, H5T_NATIVE_DOUBLE, &real));
      return real;
    case H5T_INTEGER:
      check(H5Aread(a, H5T_NATIVE_INT64, &integer));
      return integer;
    default:
      throw core::Error(std::string("attribute '") + name + "' has a type that is not ours");
  }
}

void set(Group& group, const std::string& name, const Attribute& value) {
  std::visit([&](const auto& v) { group.set(name, v); }, value);
}

// Names of attributes of a group that is left in a file: they are never written.
constexpr const char *left_file = "left in file", *left_place = "left at";

void copy_contents(hid_t to, const Group& group) {
  const List how(unlocked());
  const File file(H5Fopen(group.text(left_file).c_str(), H5F_ACC_RDONLY, how));
  const GroupId from(H5Gopen2(file, group.text(left_place).c_str(), H5P_DEFAULT));
  for (const std::string& name : names_of_attributes(from))
    if (!group.has_attribute(name)) write_attribute(to, name, read_attribute(from, name.c_str()));
  for (const std::string& name : names_of_links(from))
    check(H5Ocopy(from, name.c_str(), to, name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
}

void write_group(hid_t at, const Group& group) {
  for (const auto& [name, value] : group.attributes())
    if (name != left_file && name != left_place) write_attribute(at, name, value);
  if (is_left(group)) return copy_contents(at, group);
  for (const auto& [name, data] : group.datasets()) write_dataset(at, name, data);
  for (const auto& [name, sub] : group.groups()) {
    const GroupId g(H5Gcreate2(at, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    write_group(g, sub);
  }
}

// A rank and the number of ranks that read together.
struct Reader {
  std::size_t rank, size;
  std::filesystem::path file{};
  std::string left{};  // groups in groups of this name stay in the file
};

bool written_by_rows(hid_t dataset) {
  const List how(H5Dget_create_plist(dataset));
  H5D_fill_time_t time = H5D_FILL_TIME_IFSET;
  check(H5Pget_fill_time(how, &time));
  return time == of_rows;
}

Dataset read_dataset(hid_t at, const char* name, const Reader* reader) {
  Dataset data;
  const Data d(H5Dopen2(at, name, H5P_DEFAULT));
  const Space space(H5Dget_space(d));
  std::vector<hsize_t> extents(static_cast<std::size_t>(std::max(0, H5Sget_simple_extent_ndims(space))));
  check(H5Sget_simple_extent_dims(space, extents.data(), nullptr));
  data.shape.assign(extents.begin(), extents.end());
  if (reader && !data.shape.empty() && written_by_rows(d)) {
    const std::size_t total = data.shape.front(), begin = total * reader->rank / reader->size;
    data.share = {begin, total};
    data.shape.front() = total * (reader->rank + 1) / reader->size - begin;
    select_rows(space, begin, data.shape.front());
  }
  const auto n = static_cast<std::size_t>(H5Sget_select_npoints(space));
  const auto load = [&](hid_t type, void* values) {
    if (n == 0) return;
    const Space memory(space_of(data.shape));
    check(H5Dread(d, type, memory, space, H5P_DEFAULT, values));
  };
  const Type type(H5Dget_type(d));
  switch (H5Tget_class(type)) {
    case H5T_FLOAT:
      load(H5T_NATIVE_DOUBLE, data.values.emplace<std::vector<double>>(n).data());
      break;
    case H5T_INTEGER:
      load(H5T_NATIVE_INT64, data.values.emplace<std::vector<std::int64_t>>(n).data());
      break;
    case H5T_STRING:
      data.values = read_texts(n, load);
      break;
    default:
      throw core::Error(std::string("dataset '") + name + "' has a type that is not ours");
  }
  const auto text = [&](const char* attribute) {
    if (H5Aexists(d, attribute) <= 0) return std::string();
    const Attribute a = read_attribute(d, attribute);
    return std::holds_alternative<std::string>(a) ? std::get<std::string>(a) : std::string();
  };
  data.unit = text("unit");
  data.description = text("description");
  data.labels = read_labels(d);
  return data;
}

Group read_group(hid_t at, const Reader* reader, const std::string& path = "", bool leave = false) {
  Group group;
  for (const std::string& name : names_of_attributes(at)) set(group, name, read_attribute(at, name.c_str()));
  if (leave) {
    leave_in_file(group, reader->file, path);
    return group;
  }
  for (const std::string& name : names_of_links(at)) {
    H5O_info_t info;
    check(H5Oget_info_by_name2(at, name.c_str(), &info, H5O_INFO_BASIC, H5P_DEFAULT));
    if (info.type == H5O_TYPE_DATASET) {
      group.put(name, read_dataset(at, name.c_str(), reader));
    } else if (info.type == H5O_TYPE_GROUP) {
      const GroupId g(H5Gopen2(at, name.c_str(), H5P_DEFAULT));
      const bool in_left = reader && !reader->left.empty() && path.ends_with("/" + reader->left);
      group.child(name) = read_group(g, reader, path + "/" + name, in_left);
    }
  }
  return group;
}

Group read_file(const std::filesystem::path& path, const Reader* reader) {
  const Quiet quiet;
  if (!std::filesystem::exists(path)) throw core::Error("cannot read " + path.string() + ": there is no such file");
  try {
    const List how(unlocked());
    const File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, how));
    return read_group(file, reader);
  } catch (const core::Bug&) {
    throw core::Error("cannot read " + path.string() + ": its contents do not fit together");
  } catch (const core::Error& e) {
    throw core::Error("cannot read " + path.string() + ": " + e.what());
  }
}

void moved_to(Group& group, const std::string& path, const std::filesystem::path& file) {
  if (is_left(group)) return leave_in_file(group, file, path);
  for (const auto& [name, inner] : group.groups()) moved_to(group.child(name), path + "/" + name, file);
}

bool leaves_any(const Group& group) {
  return is_left(group) ||
         std::any_of(group.groups().begin(), group.groups().end(), [](const auto& g) { return leaves_any(g.second); });
}
// Straight into the file: what is left elsewhere is not brought into memory.
void write_through(const std::filesystem::path& path, const Group& root) {
  replace_file(path, [&](const std::filesystem::path& part) {
    try {
      File file(H5Fcreate(part.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
      write_group(file, root);
      check(H5Fflush(file, H5F_SCOPE_GLOBAL));
      file.close();
    } catch (const core::Error& e) {
      throw core::Error("cannot write " + path.string() + ": " + e.what());
    }
  });
}

}  // namespace

std::string image_of(const Group& root) {
  const List how(in_memory());
  const File file(H5Fcreate("whirl results in memory.h5", H5F_ACC_TRUNC, H5P_DEFAULT, how));
  write_group(file, root);
  check(H5Fflush(file, H5F_SCOPE_GLOBAL));
  const ssize_t size = H5Fget_file_image(file, nullptr, 0);
  if (size < 0) throw core::Error(reason());
  std::string bytes(static_cast<std::size_t>(size), '\0');
  if (H5Fget_file_image(file, bytes.data(), bytes.size()) < 0) throw core::Error(reason());
  return bytes;
}

void select_rows(hid_t space, std::size_t begin, std::size_t rows) {
  std::vector<hsize_t> start(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space))), count(start.size());
  check(H5Sget_simple_extent_dims(space, count.data(), nullptr));
  if (rows == 0 || H5Sget_simple_extent_npoints(space) == 0) return check(H5Sselect_none(space));
  start.front() = begin;
  count.front() = rows;
  check(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr));
}

void write_hdf5(const std::filesystem::path& path, const Group& root) {
  core::require(!is_shared(root), "shared datasets are written by all ranks");
  const Quiet quiet;
  std::string bytes;
  if (leaves_any(root)) return write_through(path, root);
  try {
    bytes = image_of(root);
  } catch (const core::Error& e) {
    throw core::Error("cannot write " + path.string() + ": " + e.what());
  }
  replace_file(path, bytes);
}

Group read_hdf5(const std::filesystem::path& path) {
  return read_file(path, nullptr);
}

Group read_hdf5(const std::filesystem::path& path, MPI_Comm comm, const std::string& left) {
  const Reader reader{static_cast<std::size_t>(core::rank_of(comm)), static_cast<std::size_t>(core::size_of(comm)),
                      path, left};
  return read_file(path, &reader);
}

void leave_in_file(Group& group, const std::filesystem::path& file, const std::string& place) {
  Group empty;
  for (const auto& [name, value] : group.attributes()) set(empty, name, value);
  empty.set(left_file, file.string());
  empty.set(left_place, place);
  group = std::move(empty);
}

bool is_left(const Group& group) {
  return group.has_attribute(left_file);
}

Group with_contents(const Group& group) {
  if (!is_left(group)) return group;
  const Quiet quiet;
  const std::string &path = group.text(left_file), &place = group.text(left_place);
  try {
    const List how(unlocked());
    const File file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, how));
    const GroupId g(H5Gopen2(file, place.c_str(), H5P_DEFAULT));
    Group out = read_group(g, nullptr);
    for (const auto& [name, value] : group.attributes())
      if (name != left_file && name != left_place) set(out, name, value);
    return out;
  } catch (const core::Error& e) {
    throw core::Error("cannot read " + place + " of " + path + ": " + e.what());
  }
}

void moved_to(Group& root, const std::filesystem::path& file) {
  moved_to(root, "", file);
}

std::string to_bytes(const Group& root) {
  core::require(!is_shared(root), "no rank has the whole of a shared dataset");
  const Quiet quiet;
  return image_of(root);
}

Group from_bytes(const std::string& bytes) {
  const Quiet quiet;
  const List how(in_memory());
  std::string image = bytes;
  check(H5Pset_file_image(how, image.data(), image.size()));
  const File file(H5Fopen("whirl results in memory.h5", H5F_ACC_RDONLY, how));
  return read_group(file, nullptr);
}

}  // namespace whirl::io
