#pragma once
// Codecs of the supported C++ types: doubles, Quantity, Range, int, bool, string, enums, optional, array, vector, map,
// described structs, and `std::variant<std::string, S>` (a name, or an S written in place).
//
// The work is in type-erased codecs; the templates below only tell them how to reach into a container.

#include <array>
#include <map>
#include <optional>
#include <variant>

#include "whirl/deck/description.hpp"

namespace whirl::deck {

using CodecPtr = std::shared_ptr<const Codec>;

/// How a type-erased codec reaches into a container.
struct ListAccess {
  std::function<bool(void*, std::size_t)> resize;  ///< false if the container cannot have that many items
  std::function<std::size_t(const void*)> size;
  std::function<void*(void*, std::size_t)> at;
  std::size_t fixed = 0;  ///< number of items it must have, 0 for any
};
struct MapAccess {
  std::function<void(void*)> clear;
  std::function<void*(void*, const std::string&)> insert;
  std::function<std::vector<std::pair<std::string, void*>>(void*)> entries;
};
struct OptionalAccess {
  std::function<void*(void*)> emplace;
  std::function<void(void*)> reset;
  std::function<void*(void*)> get;  ///< null if empty
};
struct NameOrAccess {
  std::function<void(void*, const std::string&)> set_name;
  std::function<void*(void*)> set_value;
  std::function<const std::string*(const void*)> name;  ///< null if it holds a value
  std::function<void*(void*)> value;                    ///< null if it holds a name
};
struct ChoiceAccess {
  std::function<void(void*)> clear;
  std::function<void*(void*, std::size_t)> append;  ///< makes an object of that kind, returns its options
  std::function<std::size_t(const void*)> size;
  std::function<std::size_t(const void*, std::size_t)> kind;
  std::function<void*(void*, std::size_t)> options;
};
struct ChoiceKind {
  std::string name;
  std::string text;
  const Structure* options;
};
struct Choice {
  std::string name;
  std::string text;
};
/// One of several structs inside a struct.
struct KindAccess {
  std::function<void*(void*)> holder;            ///< what holds one of them, of the whole struct
  std::function<std::size_t(const void*)> kind;  ///< of the holder: which one it holds
  std::function<void(void*, std::size_t)> hold;  ///< a new one, unless it holds one of that kind already
  std::function<void*(void*)> value;             ///< of the holder: the one that it holds
};

[[nodiscard]] CodecPtr real_codec(Spec spec);
[[nodiscard]] CodecPtr quantity_codec(Spec spec);
[[nodiscard]] CodecPtr range_codec(Spec spec);
[[nodiscard]] CodecPtr integer_codec(Spec spec);
[[nodiscard]] CodecPtr flag_codec();
[[nodiscard]] CodecPtr text_codec();
[[nodiscard]] CodecPtr choice_codec(std::vector<Choice> choices, std::function<std::size_t(const void*)> get,
                                    std::function<void(void*, std::size_t)> set);
[[nodiscard]] CodecPtr list_codec(CodecPtr item, ListAccess access);
[[nodiscard]] CodecPtr table_codec(const Structure& row, ListAccess access, std::string scalar);
[[nodiscard]] CodecPtr map_codec(CodecPtr item, MapAccess access);
[[nodiscard]] CodecPtr optional_codec(CodecPtr item, OptionalAccess access);
[[nodiscard]] CodecPtr name_or_codec(CodecPtr value, NameOrAccess access);
[[nodiscard]] CodecPtr choices_codec(std::vector<ChoiceKind> kinds, ChoiceAccess access);
[[nodiscard]] CodecPtr struct_codec(const Structure& structure);
/// Adds to `s` the choice `chooser` among `kinds`, whose codec and value it lacks, and the options of all kinds.
void add_kinds(Structure& s, Option chooser, const std::vector<ChoiceKind>& kinds, const KindAccess& access);

template <class S>
const Structure& structure_of() {
  static const Structure structure = [] {
    Structure s;
    s.defaults = std::make_shared<S>();
    Description<S> d(s);
    describe(d);
    return s;
  }();
  return structure;
}

/// Every type without an own codec below is a described struct.
template <class T, class>
struct CodecOf {
  static CodecPtr make(const Spec&) { return struct_codec(structure_of<T>()); }
};
template <>
struct CodecOf<double> {
  static CodecPtr make(const Spec& s) { return real_codec(s); }
};
template <>
struct CodecOf<Quantity> {
  static CodecPtr make(const Spec& s) { return quantity_codec(s); }
};
template <>
struct CodecOf<Range> {
  static CodecPtr make(const Spec& s) { return range_codec(s); }
};
template <>
struct CodecOf<int> {
  static CodecPtr make(const Spec& s) { return integer_codec(s); }
};
template <>
struct CodecOf<bool> {
  static CodecPtr make(const Spec&) { return flag_codec(); }
};
template <>
struct CodecOf<std::string> {
  static CodecPtr make(const Spec&) { return text_codec(); }
};

template <class E>
struct CodecOf<E, std::enable_if_t<std::is_enum_v<E>>> {
  static CodecPtr make(const Spec&) {
    std::vector<Choice> choices;
    for (const Name<E>& n : names(E{})) choices.push_back({std::string(n.name), std::string(n.text)});
    return choice_codec(
        std::move(choices),
        [](const void* v) {
          std::size_t i = 0;
          for (const Name<E>& n : names(E{})) {
            if (n.value == *static_cast<const E*>(v)) return i;
            ++i;
          }
          throw core::Bug("an enum value has no row in its string table");
        },
        [](void* v, std::size_t i) { *static_cast<E*>(v) = names(E{})[i].value; });
  }
};

/// Name of an enum value in its string table.
template <class E>
[[nodiscard]] std::string_view name_of(E value) {
  for (const Name<E>& n : names(E{}))
    if (n.value == value) return n.name;
  throw core::Bug("an enum value has no row in its string table");
}

template <class T>
[[nodiscard]] ListAccess vector_access() {
  using V = std::vector<T>;
  return {.resize =
              [](void* v, std::size_t n) {
                static_cast<V*>(v)->clear();
                static_cast<V*>(v)->resize(n);
                return true;
              },
          .size = [](const void* v) { return static_cast<const V*>(v)->size(); },
          .at = [](void* v, std::size_t i) -> void* { return &(*static_cast<V*>(v))[i]; }};
}
template <class T>
struct CodecOf<std::vector<T>> {
  static CodecPtr make(const Spec& s) { return list_codec(CodecOf<T>::make(s), vector_access<T>()); }
};
template <class T, std::size_t N>
struct CodecOf<std::array<T, N>> {
  using A = std::array<T, N>;
  static CodecPtr make(const Spec& s) {
    return list_codec(CodecOf<T>::make(s),
                      {.resize = [](void*, std::size_t n) { return n == N; },
                       .size = [](const void*) { return N; },
                       .at = [](void* v, std::size_t i) -> void* { return &(*static_cast<A*>(v))[i]; },
                       .fixed = N});
  }
};
template <class T>
struct CodecOf<std::map<std::string, T>> {
  using M = std::map<std::string, T>;
  static CodecPtr make(const Spec& s) {
    return map_codec(CodecOf<T>::make(s),
                     {.clear = [](void* v) { static_cast<M*>(v)->clear(); },
                      .insert = [](void* v, const std::string& k) -> void* { return &(*static_cast<M*>(v))[k]; },
                      .entries =
                          [](void* v) {
                            std::vector<std::pair<std::string, void*>> e;
                            for (auto& [k, x] : *static_cast<M*>(v)) e.emplace_back(k, &x);
                            return e;
                          }});
  }
};
template <class T>
struct CodecOf<std::optional<T>> {
  using O = std::optional<T>;
  static CodecPtr make(const Spec& s) {
    return optional_codec(CodecOf<T>::make(s),
                          {.emplace = [](void* v) -> void* { return &static_cast<O*>(v)->emplace(); },
                           .reset = [](void* v) { static_cast<O*>(v)->reset(); },
                           .get = [](void* v) -> void* {
                             auto* o = static_cast<O*>(v);
                             return o->has_value() ? &**o : nullptr;
                           }});
  }
};
template <class T>
struct CodecOf<std::variant<std::string, T>> {
  using V = std::variant<std::string, T>;
  static CodecPtr make(const Spec& s) {
    return name_or_codec(CodecOf<T>::make(s),
                         {.set_name = [](void* v, const std::string& name) { *static_cast<V*>(v) = name; },
                          .set_value = [](void* v) -> void* { return &static_cast<V*>(v)->template emplace<T>(); },
                          .name = [](const void* v) { return std::get_if<std::string>(static_cast<const V*>(v)); },
                          .value = [](void* v) -> void* { return std::get_if<T>(static_cast<V*>(v)); }});
  }
};

template <class S>
template <class E>
const typename Description<S>::Line& Description<S>::Line::only(E S::*selector, std::initializer_list<E> values) const {
  auto* defaults = static_cast<S*>(s_.defaults.get());
  Option& mine = s_.options[i_];
  for (const Option& o : s_.options)
    if (o.member(defaults) == static_cast<void*>(&(defaults->*selector))) mine.selector = o.key;
  core::require(!mine.selector.empty(), "the choice that selects an option must be described before it");
  for (E v : values) mine.selected.emplace_back(name_of(v));
  return *this;
}

template <class S>
template <class R>
typename Description<S>::Line Description<S>::table(std::string key, std::vector<R> S::*member, std::string text,
                                                    std::string source) {
  return push(std::move(key), member, table_codec(structure_of<R>(), vector_access<R>(), {}), std::move(text),
              std::move(source));
}

template <class S>
template <class R, class Row>
typename Description<S>::Line Description<S>::table_or_scalar(std::string key, std::vector<R> S::*member,
                                                              std::string scalar, const Row& row, std::string text,
                                                              std::string source) {
  static const Structure structure = [&row] {
    Structure x;
    x.defaults = std::make_shared<R>();
    Description<R> d(x);
    row(d);
    return x;
  }();
  return push(std::move(key), member, table_codec(structure, vector_access<R>(), std::move(scalar)), std::move(text),
              std::move(source));
}

template <class S>
template <class R>
typename Description<S>::Line Description<S>::named(std::string key, std::vector<R> S::*member, std::string R::*name,
                                                    std::string text, std::string source) {
  using V = std::vector<R>;
  MapAccess access{.clear = [](void* v) { static_cast<V*>(v)->clear(); },
                   .insert = [name](void* v, const std::string& k) -> void* {
                     R& r = static_cast<V*>(v)->emplace_back();
                     r.*name = k;
                     return &r;
                   },
                   .entries =
                       [name](void* v) {
                         std::vector<std::pair<std::string, void*>> e;
                         for (R& r : *static_cast<V*>(v)) e.emplace_back(r.*name, &r);
                         return e;
                       }};
  return push(std::move(key), member, map_codec(struct_codec(structure_of<R>()), std::move(access)), std::move(text),
              std::move(source));
}

template <class S>
template <class B>
typename Description<S>::Line Description<S>::choices(std::string key, std::vector<std::unique_ptr<B>> S::*member,
                                                      const std::vector<Kind<B>>& kinds, std::string text,
                                                      std::string source) {
  using V = std::vector<std::unique_ptr<B>>;
  std::vector<ChoiceKind> erased;
  for (const Kind<B>& k : kinds) erased.push_back({k.name, k.text, k.options});
  auto kind_of = [kinds](const B& object) {
    std::size_t i = 0;
    while (i < kinds.size() && kinds[i].name != object.kind()) ++i;
    core::require(i < kinds.size(), "an object of a kind that is not in the list of kinds");
    return i;
  };
  ChoiceAccess access{
      .clear = [](void* v) { static_cast<V*>(v)->clear(); },
      .append = [kinds](void* v, std::size_t kind) -> void* {
        auto& o = static_cast<V*>(v)->emplace_back(kinds[kind].make());
        return kinds[kind].object(*o);
      },
      .size = [](const void* v) { return static_cast<const V*>(v)->size(); },
      .kind = [kind_of](const void* v, std::size_t i) { return kind_of(*(*static_cast<const V*>(v))[i]); },
      .options = [kinds, kind_of](void* v, std::size_t i) -> void* {
        B& o = *(*static_cast<V*>(v))[i];
        return kinds[kind_of(o)].object(o);
      }};
  return push(std::move(key), member, choices_codec(std::move(erased), std::move(access)), std::move(text),
              std::move(source));
}

template <class S>
template <class... K>
typename Description<S>::Line Description<S>::kinds(std::string key, std::variant<K...> S::*member, std::string text,
                                                    std::string source) {
  using V = std::variant<K...>;
  const std::size_t at = s_.options.size();
  Option chooser;
  chooser.key = std::move(key);
  chooser.text = std::move(text);
  chooser.source = std::move(source);
  chooser.value = &typeid(V);
  add_kinds(s_, std::move(chooser), {{std::string(K::key), std::string(K::text), &structure_of<K>()}...},
            {.holder = [member](void* s) -> void* { return &(static_cast<S*>(s)->*member); },
             .kind = [](const void* v) { return static_cast<const V*>(v)->index(); },
             .hold =
                 [](void* v, std::size_t kind) {
                   auto& held = *static_cast<V*>(v);
                   std::size_t k = 0;
                   if (kind != held.index()) ((k++ == kind ? void(held.template emplace<K>()) : void()), ...);
                 },
             .value = [](void* v) { return std::visit([](auto& x) -> void* { return &x; }, *static_cast<V*>(v)); }});
  return Line(s_, at);
}

template <class S>
void Description<S>::take_over(const Structure& inner, const std::function<void*(void*)>& part) {
  for (Option o : inner.options) {
    o.member = [part, f = o.member](void* s) { return f(part(s)); };
    if (const void* own = o.member(s_.defaults.get())) o.preset = own;
    s_.options.push_back(std::move(o));
  }
  for (const Structure::Checker& c : inner.checks)
    s_.checks.push_back([part, c](const void* s, const Report& r) { c(part(const_cast<void*>(s)), r); });
}

template <class S>
template <class T>
void Description<S>::embed(T S::*member) {
  take_over(structure_of<T>(), [member](void* s) -> void* { return &(static_cast<S*>(s)->*member); });
}

template <class S>
template <class B>
void Description<S>::inherit() {
  take_over(structure_of<B>(), [](void* s) -> void* { return static_cast<B*>(static_cast<S*>(s)); });
}

/// find_option for a type-erased object.
[[nodiscard]] Access find_in(const Structure& structure, void* object, std::string_view path);

template <class S>
Access find_option(S& object, std::string_view path) {
  return find_in(structure_of<S>(), &object, path);
}

template <class S>
S read(const Node& node, const Files& files, Problems& problems) {
  S object{};
  Reading reading{files, problems};
  structure_of<S>().read(node, &object, reading);
  return object;
}

template <class S>
Node write(const S& object) {
  return structure_of<S>().write(&object);
}

}  // namespace whirl::deck
