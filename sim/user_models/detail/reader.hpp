#pragma once
// Reader of user-defined models: resolves names, adds expressions to the graph and converts blocks to states.
#include <map>
#include <optional>

#include "base/config.hpp"
#include "sim/user_models/detail/definition.hpp"

namespace swingbank::sim::user_models {

/// An expression and its key ("states.x.derivative").
struct Expression {
  std::string key, text;
  Tree tree;
};

/// Reader of one user-defined model.
class Reader {
 public:
  Reader(const std::string& text, const std::filesystem::path& name);
  Definition read();

 private:
  /// An expression or a block's output that has a name.
  struct Named {
    enum class Kind { signal, reference, block } kind;
    Expression expression;  ///< empty for blocks
    int vertex = -1;
    bool open = false;  ///< being resolved; a second visit is an algebraic loop
  };
  struct StateEntry {
    std::string name, unit, meaning;
    double weight = 1.0;
    int derivative = -1, low = -1, high = -1, start = -1;  ///< vertices
  };
  struct Block {
    std::string kind, before;  ///< before: name of the preceding block in the chain
    int first_state = -1;
  };

  // Defined in reader.cpp:
  void read_head();
  void read_entry_point();
  void read_parameters();
  void read_signals();
  void read_states();
  void read_references();
  void read_requirements();
  void read_output();
  [[nodiscard]] bool bends() const;
  void finish();
  bool claim(const std::string& key, const std::string& name, const char* what);
  std::vector<std::string> in_file_order(const std::string& table);
  std::string describe() const;

  // Defined in lookup.cpp:
  std::optional<Expression> expression(const std::string& key, bool condition = false);
  int value(const std::string& key, std::optional<double> otherwise = {});
  int lower(const Tree& tree, const std::string& key);
  int look_up(const Node& name, const std::string& key);
  int operating_value(const Node& name, const std::string& key, int signal, const std::string& signal_name);
  int signal(const Node& name, const std::string& key, int index);
  int named(const Node& name, const std::string& key, Named& entry);
  int state_value(int index);
  std::string names() const;
  std::string place(const std::string& key, std::size_t offset) const;
  void problem(const std::string& key, std::size_t offset, std::string what, std::string why,
               std::string remedy);

  // Defined in blocks.cpp:
  void read_blocks();
  int block_output(const std::string& name);
  void finish_block(const std::string& name);
  int block_input(const std::string& name);
  int limited(const std::string& name, int vertex);
  int with_gain(const std::string& name, int vertex);
  int first_order(const std::string& name, Block& block);
  void transfer_function_states(const std::string& name, Block& block);
  std::vector<int> list(const std::string& key);
  bool surely_positive(int vertex) const;
  int add_state(const std::string& name, const std::string& meaning);
  double state_weight(const std::string& key);

  std::string text_, file_;
  Config config_;
  Problems problems_;
  Definition user_model_;
  Graph graph_;
  int coefficients_ = kFirstParameter;
  std::map<std::string, std::string> taken_;         ///< name -> kind of its owner
  std::map<std::string, int> parameter_;             ///< name -> index
  std::map<std::string, int> operating_, searched_;  ///< name -> vertex
  std::map<std::string, Named> named_;
  std::map<std::string, int> state_;  ///< name -> index
  std::map<std::string, Block> blocks_;
  std::vector<std::string> block_order_;
  std::string last_in_chain_;
  std::map<std::string, int> values_;  ///< key -> vertex, for keys that are read more than once
  std::vector<StateEntry> states_;
  std::vector<Expression> read_;  ///< all expressions, for the description
  int own_ = -1;                  ///< state whose derivative is being read
  int output_ = -1;               ///< vertex of the output
  std::vector<std::pair<int, int>> requirement_vertices_;
  std::vector<int> switching_time_vertices_;
};

}  // namespace swingbank::sim::user_models
