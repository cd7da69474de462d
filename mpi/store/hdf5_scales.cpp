// Labels, units and dimension scales of HDF5 arrays, which viewers, h5py and xarray use to display axes. The
// attributes are those of HDF5's Dimension Scale Specification. libhdf5_hl writes the same attributes, but it
// rewrites a scale's list for each attached array, which leaves unused space in the file.
#include <algorithm>
#include <cstring>
#include <map>

#include "mpi/store/hdf5_file.hpp"

namespace swingbank::mpi::store::h5 {

namespace {

/// Entry of a scale's REFERENCE_LIST: an array, and the index of the array's axis to which the scale belongs.
struct ScaleUse {
  hobj_ref_t array;
  std::int32_t axis;
};

Handle label_type(std::size_t length) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(length, 1));
  H5Tset_strpad(type.get(), H5T_STR_NULLPAD);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

std::size_t longest(const std::vector<std::string>& labels) {
  std::size_t length = 0;
  for (const auto& label : labels) length = std::max(length, label.size());
  return length;
}

/// Returns the type of a zero-terminated text of fixed length, which the specification requires for CLASS.
Handle zero_terminated(const std::string& text) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), text.size() + 1);
  return type;
}

Handle use_type(hid_t index_type) {
  Handle type(H5Tcreate(H5T_COMPOUND, sizeof(ScaleUse)), H5Tclose);
  H5Tinsert(type.get(), "dataset", HOFFSET(ScaleUse, array), H5T_STD_REF_OBJ);
  H5Tinsert(type.get(), "dimension", HOFFSET(ScaleUse, axis), index_type);
  return type;
}

}  // namespace

void File::create_labels(const std::string& object, const std::vector<std::string>& labels) {
  create(object, label_type(longest(labels)).get(), {labels.size()});
}

void File::write_labels(const std::string& object, const std::vector<std::string>& labels) {
  const std::size_t length = std::max<std::size_t>(longest(labels), 1);
  std::string text(length * labels.size(), '\0');
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i].copy(text.data() + i * length, length);
  transfer(object, 0, labels.size(), label_type(length).get(), nullptr, text.data());
}

void File::describe(const std::string& object, const std::string& units, const std::string& long_name) {
  attribute("units", units, object);
  attribute("long_name", long_name, object);
}

void File::attach_scales(const std::vector<Axes>& all) {
  const auto reference = [&](const std::string& object) {
    hobj_ref_t to = 0;
    if (H5Rcreate(&to, file_.get(), object.c_str(), H5R_OBJECT, -1) < 0)
      fail("cannot refer to the array", object);
    return to;
  };
  std::map<std::string, std::vector<ScaleUse>> uses;
  const Handle list(H5Tvlen_create(H5T_STD_REF_OBJ), H5Tclose);
  for (const auto& [array, scales] : all) {
    const hobj_ref_t of_array = reference(array);
    std::vector<hobj_ref_t> references;
    for (const auto& scale : scales) {
      ScaleUse use;
      std::memset(&use, 0, sizeof use);  // also clears the padding, which is written to the file
      use.array = of_array;
      use.axis = static_cast<std::int32_t>(references.size());
      uses[scale].push_back(use);
      references.push_back(reference(scale));
    }
    std::vector<hvl_t> lists;
    for (auto& r : references) lists.push_back({1, &r});
    put(array, "DIMENSION_LIST", list.get(), list.get(), {lists.size()}, lists.data());
  }
  const Handle in_file = use_type(H5T_STD_I32LE), in_memory = use_type(H5T_NATIVE_INT32);
  for (const auto& [scale, of_scale] : uses) {
    const std::string kind = "DIMENSION_SCALE", name = scale.substr(scale.rfind('/') + 1);
    for (const auto& [attribute_name, text] : {std::pair{"CLASS", &kind}, std::pair{"NAME", &name}}) {
      const Handle type = zero_terminated(*text);
      put(scale, attribute_name, type.get(), type.get(), {}, text->c_str());
    }
    put(scale, "REFERENCE_LIST", in_file.get(), in_memory.get(), {of_scale.size()}, of_scale.data());
  }
}

}  // namespace swingbank::mpi::store::h5
