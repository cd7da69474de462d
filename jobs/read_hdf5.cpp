// swingbank-read-hdf5: what base/read_apart starts to read files that the libraries may crash on. No command
// for people: it answers in bytes.
//   swingbank-read-hdf5 hdf5 FILE NAME...      arrays and attributes (mpi/store/hdf5_apart.hpp)
//   swingbank-read-hdf5 mat FILE [TIME]        a MATLAB file as text in columns
//   (validate/record/mat_text.hpp)
#include <cstdio>
#include <string>
#include <vector>

#include "base/read_apart.hpp"
#include "mpi/store/hdf5_apart.hpp"
#include "validate/record/mat_text.hpp"

int main(int argc, char** argv) {
  using namespace swingbank;
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 2 || (words[0] != "hdf5" && words[0] != "mat")) {
    std::fprintf(stderr,
                 "wrong words at swingbank-read-hdf5 (other programs of swingbank start it): start those\n");
    return 1;
  }
  const std::string& file = words[1];
  const std::vector<std::string> rest(words.begin() + 2, words.end());
  return answer_apart(file, [&] {
    return words[0] == "hdf5" ? mpi::store::h5::read_asked(file, rest)
                              : validate::record::mat_text(file, rest.empty() ? "" : rest[0]);
  });
}
