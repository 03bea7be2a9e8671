// What a plugin in a shared library says of itself, made of the input's bytes; and the same as a
// child sends it to the process that started it. What is accepted is the same behind that border.
#include <cmath>
#include <cstring>
#include <deque>

#include "base/text.hpp"
#include "fuzz/harness.hpp"
#include "optimizers/plugins/plugin_description.hpp"

namespace armwright::fuzz {
namespace {

// Takes an input apart; behind its end there are zeros.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : rest_(bytes) {}

  template <class Number>
  Number take() {
    Number number{};
    const std::size_t count = std::min(sizeof number, rest_.size());
    std::memcpy(&number, rest_.data(), count);
    rest_.remove_prefix(count);
    return number;
  }
  // Up to a zero byte; NULL if it begins with 0xFF.
  const char* take_text() {
    const std::size_t end = rest_.find('\0');
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
    return text.starts_with('\xFF') ? nullptr : texts_.emplace_back(text).c_str();
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
  std::deque<std::string> texts_;
};

int minimize(const armwright_problem*, const armwright_evaluator*, const armwright_options*,
             std::uint64_t, char*, std::size_t) {
  return 0;
}

void check_description(const PluginDescription& description) {
  require(sanitize(description.summary) == description.summary, "a summary is not printable");
  for (const OptionSpec& spec : description.options) {
    require(!spec.name.empty() && sanitize(spec.name) == spec.name, "a name that is none");
    const std::string assignment = spec.name + "=" + to_text(spec.fallback);
    try {
      const Options parsed = Options::parse("plugin", description.options, {&assignment, 1});
      require(parsed.values() == Options::parse("plugin", description.options, {}).values(),
              "an option's default reads back as another");
    } catch (const Error& error) {
      throw BrokenPromise(std::string("an option's default is not allowed: ") + error.what());
    }
  }
  PacketWriter writer;
  pack(description, writer);
  PacketReader reader(writer.bytes());
  PacketWriter again;
  pack(unpack_description(reader), again);
  require(again.bytes() == writer.bytes(), "another description crosses the border");
}

void read_struct(Bytes& bytes) {
  struct armwright_plugin plugin {};
  plugin.abi = ARMWRIGHT_PLUGIN_ABI;
  plugin.struct_size = sizeof plugin;
  const auto flags = bytes.take<std::uint8_t>();
  plugin.name = bytes.take_text();
  plugin.summary = bytes.take_text();
  plugin.source = bytes.take_text();
  plugin.capabilities = bytes.take<std::uint16_t>();
  plugin.minimize = (flags & 1) != 0 ? nullptr : &minimize;
  std::deque<std::vector<const char*>> choices;
  std::vector<armwright_option> options(bytes.take<std::uint8_t>());
  for (armwright_option& option : options) {
    option.name = bytes.take_text();
    option.description = bytes.take_text();
    option.type = static_cast<decltype(option.type)>(bytes.take<std::uint8_t>());
    option.fallback = bytes.take<double>();
    option.lower = bytes.take<double>();
    option.upper = bytes.take<double>();
    option.fallback_text = bytes.take_text();
    auto& own = choices.emplace_back();
    for (auto left = bytes.take<std::uint8_t>(); left > 0; --left) {
      own.push_back(bytes.take_text());
    }
    own.push_back(nullptr);
    option.choices = own.size() == 1 ? nullptr : own.data();
  }
  plugin.options = options.empty() ? nullptr : options.data();
  plugin.option_count = (flags & 2) != 0 ? std::size_t{1} << 40 : options.size();
  const std::vector<std::string> own_options = {"isolate", "log"};
  check_description(describe_plugin(plugin, own_options));
}

void read_packet(std::string_view bytes) {
  PacketReader reader(bytes);
  unpack_description(reader);
}

}  // namespace

void fuzz_descriptor(std::string_view input) {
  Bytes bytes(input);
  if (bytes.take<std::uint8_t>() % 2 == 0) {
    is_read<PluginRefusal>([&] { read_struct(bytes); });
  } else {
    is_read<PacketError>([&] { read_packet(bytes.rest()); });
  }
}

}  // namespace armwright::fuzz
