// A JSON value that knows its place in the file. A large scene has millions of them, so a value is
// small: what arrays, objects and strings hold stands elsewhere, and the JSON pointer of a value is
// put together only where somebody asks for it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace apothem {

/// A value of a document. Where it stands is known from the arrays and objects around it, so a copy
/// of a part of a document must not outlive the document.
class JsonValue {
 public:
  enum class Type { null, boolean, number, string, array, object };

  /// null, false, 0, or empty. `line`: in the file, counted from 1.
  explicit JsonValue(Type type = Type::null, int line = 0);
  JsonValue(const JsonValue& other);
  JsonValue(JsonValue&& other) noexcept;
  JsonValue& operator=(const JsonValue& other);
  JsonValue& operator=(JsonValue&& other) noexcept;
  ~JsonValue();

  [[nodiscard]] Type type() const { return static_cast<Type>(data_.index()); }
  /// What a value of that type holds. Any other value holds false, 0, or nothing.
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] double number() const;
  [[nodiscard]] const std::string& string() const;
  /// Elements of an array, or values of an object.
  [[nodiscard]] const std::vector<JsonValue>& items() const;
  /// Keys of an object, unique, in the order of the file.
  [[nodiscard]] const std::vector<std::string>& keys() const;
  /// The value of a key, or nullptr if there is none or this is no object.
  [[nodiscard]] const JsonValue* find(std::string_view key) const;

  /// Counted from 1; 0 for a value that stands in no line.
  [[nodiscard]] int line() const { return line_; }
  /// JSON pointer (RFC 6901), empty for the document.
  [[nodiscard]] std::string pointer() const;

  /// Makes this a value of another type.
  void set(bool value);
  void set(double value);
  void set(std::string value);

  // Of an array or an object only. References to its items are valid until the next one is added.

  [[nodiscard]] JsonValue& item(size_t i);
  [[nodiscard]] JsonValue* find(std::string_view key);
  /// Adds a value, which gets its place here. `key`: of an object.
  JsonValue& add(JsonValue value, std::string key = {});
  /// Adds a value that keeps the place that it had.
  JsonValue& add_from_elsewhere(JsonValue value, std::string key = {});

  /// Frees the memory of all items.
  void drop_items();

  /// Makes this value stand where another one stands, and in the same line.
  void stand_at(const JsonValue& other);
  /// Makes this value, and all that it holds, stand in no line.
  void leave_line();

  /// The keys of an object.
  using Keys = std::shared_ptr<std::vector<std::string>>;
  /// Uses `keys` if they are the same as the object's own, so that objects that are alike share
  /// them, and otherwise puts its own there.
  void share_keys(Keys& keys);

 private:
  struct Container;
  struct Array;
  struct Object;

  [[nodiscard]] Container* container();
  [[nodiscard]] const Container* container() const;
  void place(const Container* in, int index);

  // In the order of Type.
  std::variant<std::monostate, bool, double, std::unique_ptr<std::string>, std::unique_ptr<Array>,
               std::unique_ptr<Object>>
      data_;
  const Container* in_ = nullptr;  // nothing for a document
  int index_ = 0;                  // among the items of what it stands in
  int line_ = 0;
};

/// A key as it stands in a JSON pointer (RFC 6901).
std::string escaped_key(const std::string& key);

}  // namespace apothem
