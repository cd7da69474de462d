// swingbank-read-hdf5: reader of untrusted files, started by base/read_apart because HDF5 and libmatio may
// crash on them. It writes the content to standard output.
//   swingbank-read-hdf5 hdf5 FILE NAME...  arrays and attributes (mpi/store/hdf5_apart.hpp)
//   swingbank-read-hdf5 mat FILE [TIME]    MATLAB file as text in columns (validate/record/mat_text.hpp)
#include <cstdio>
#include <string>
#include <vector>

#include "base/read_apart.hpp"
#include "jobs/command_line.hpp"
#include "mpi/store/hdf5_apart.hpp"
#include "validate/record/mat_text.hpp"

int main(int argc, char** argv) {
  using namespace swingbank;
  std::string kind, file;
  std::vector<std::string> names;
  if (argc < 3) {  // complete commands are not parsed, because file names may begin with a dash
    jobs::CommandLine line(
        "read an HDF5 or MATLAB file in a separate process, so that a crash does not end the calling command",
        "swingbank read-hdf5");
    line.add("KIND", kind, "format of the file").required().one_of({"hdf5", "mat"});
    line.add("FILE", file, "data to read; the output is bytes, or a list of problems with exit code 3")
        .required();
    line.add("NAMES", names, "of hdf5: arrays (/records) and attributes (@format); of mat: the time column");
    (void)line.parse(argc, argv);  // always an error or help, because FILE is missing
    return line.end();
  }
  kind = argv[1];
  file = argv[2];
  names.assign(argv + 3, argv + argc);
  if (kind != "hdf5" && kind != "mat") {
    std::fprintf(stderr, "'%s' at KIND (swingbank read-hdf5 reads hdf5 and mat): choose one, or see --help\n",
                 kind.c_str());
    return 1;
  }
  return reply_apart(file, [&] {
    return kind == "hdf5" ? mpi::store::h5::read_asked(file, names)
                          : validate::record::mat_text(file, names.empty() ? "" : names[0]);
  });
}
