#!/usr/bin/env python3
"""Turns catalogue.json into C++ messages and into the tables of PROTOCOL.md.

    generate.py --out DIR   writes DIR/messages.hpp and DIR/messages.cpp
    generate.py --docs      rewrites the tables of PROTOCOL.md between its markers
    generate.py --check     exit status 1 when PROTOCOL.md is out of date
"""

import argparse
import json
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
CATALOGUE = HERE / "catalogue.json"
DOCS = HERE / "PROTOCOL.md"

SCALARS = {"u8": "std::uint8_t", "u32": "std::uint32_t", "u64": "std::uint64_t", "f64": "double"}
ARRAYS = {"u8s": "std::uint8_t", "i32s": "std::int32_t", "f64s": "double"}
MOST_SYMBOLS = 8  # of class Sizes in wire/codec.hpp
STRINGS = {"str": "std::string", "strs": "std::vector<std::string>"}


class CatalogueError(Exception):
    pass


def load():
    catalogue = json.loads(CATALOGUE.read_text())
    check(catalogue)
    return catalogue


def check(catalogue):
    """Refuses what the generated code could not express."""
    names = [m["name"] for m in catalogue["messages"]]
    ids = [m["id"] for m in catalogue["messages"]]
    for what, values in (("name", names), ("id", ids)):
        twice = {v for v in values if values.count(v) > 1}
        if twice:
            raise CatalogueError(f"{what} used twice: {sorted(twice)}")
    for message in catalogue["messages"]:
        where = message["name"]
        if not 0 < message["id"] < 65536:
            raise CatalogueError(f"{where}: id {message['id']} does not fit 16 bits")
        for state in message["states"]:
            if state not in catalogue["states"]:
                raise CatalogueError(f"{where}: unknown state {state}")
        if "reply" in message and message["reply"] not in names:
            raise CatalogueError(f"{where}: unknown reply {message['reply']}")
        if message.get("becomes", "configuring") != "configuring":
            raise CatalogueError(f"{where}: becomes can only be configuring")
        symbols = {}
        for field in message["fields"]:
            kind = field["type"]
            if kind not in catalogue["types"] or kind not in {**SCALARS, **ARRAYS, **STRINGS}:
                raise CatalogueError(f"{where}.{field['name']}: unknown type {kind}")
            if (kind in ARRAYS) != ("shape" in field):
                raise CatalogueError(f"{where}.{field['name']}: arrays, and only arrays, have a shape")
            if "shape" in field:
                extents(field["shape"], symbols)
        if len(symbols) > MOST_SYMBOLS:
            raise CatalogueError(f"{where}: more than {MOST_SYMBOLS} symbols in its shapes")


def type_name(name):
    return "".join(part.capitalize() for part in name.split("_"))


def extents(shape, symbols):
    """[(symbol or -1, plus, fixed)] of a shape such as [n,3]; None where any shape will do."""
    parts = shape.strip("[]").split(",")
    if parts == ["..."]:
        return [(-2, 0, 0)]
    if "..." in parts:
        return None
    result = []
    for part in parts:
        if part.isdigit():
            result.append((-1, 0, int(part)))
            continue
        match = re.fullmatch(r"([a-z]+)(\+1)?", part)
        if not match:
            raise CatalogueError(f"cannot read the shape {shape}")
        symbol = symbols.setdefault(match[1], len(symbols))
        result.append((symbol, 1 if match[2] else 0, 0))
    if not 1 <= len(result) <= 3:
        raise CatalogueError(f"{shape}: 1 to 3 dimensions")
    return result


def rule_text(message, field, symbols):
    """The C++ initialiser of a ShapeRule."""
    where = f'{message["name"]}.{field["name"]}'
    items = extents(field["shape"], symbols)
    if items is None:
        return f'{{"{where}", "{field["shape"]}", 0, {{}}}}'
    body = ", ".join(f"Extent{{{s}, {p}, {f}}}" for s, p, f in items)
    return f'{{"{where}", "{field["shape"]}", {len(items)}, {{{body}}}}}'


def field_declaration(field):
    kind = field["type"]
    note = field["doc"] + (f' [{field["unit"]}]' if "unit" in field else "")
    if kind in SCALARS:
        text = f"{SCALARS[kind]} {field['name']} = 0;"
    elif kind in STRINGS:
        text = f"{STRINGS[kind]} {field['name']};"
    else:
        items = extents(field["shape"], {})
        start = ", ".join(str(f) if s == -1 else "0" for s, _, f in items) if items else "0"
        text = f"Array<{ARRAYS[kind]}> {field['name']}{{{start}}};"
        note += f", {field['shape']}"
    return f"  {text}  ///< {note}"


def struct_text(message):
    lines = [f"/// {message['doc']}", f"struct {type_name(message['name'])} {{"]
    lines.append(f"  static constexpr std::uint16_t id = {message['id']};")
    lines.append(f'  static constexpr std::string_view type_name = "{message["name"]}";')
    lines.append("")
    lines += [field_declaration(f) for f in message["fields"]]
    if message["fields"]:
        lines.append("")
    lines.append("  /// Appends the payload. CodecError when an array does not have the shape it must have.")
    lines.append("  void encode(Writer& writer) const;")
    lines.append("  /// Reads the payload and keeps the memory of the arrays. CodecError when it does not fit.")
    lines.append("  void decode(Reader& reader);")
    lines.append("  /// Calls visit(field name, shape or \"\", field) for each field in order.")
    lines.append("  template <class Visitor>")
    lines.append("  void visit([[maybe_unused]] Visitor&& visit) {")
    for field in message["fields"]:
        lines.append(f'    visit("{field["name"]}", "{field.get("shape", "")}", {field["name"]});')
    lines.append("  }")
    lines.append(f"  bool operator==(const {type_name(message['name'])}&) const = default;")
    lines.append("};")
    return "\n".join(lines)


def header_text(catalogue):
    states = ", ".join(catalogue["states"])
    structs = "\n\n".join(struct_text(m) for m in catalogue["messages"])
    every = ", ".join(type_name(m["name"]) for m in catalogue["messages"])
    return f"""#pragma once
// Generated from protocol/catalogue.json by protocol/generate.py.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "protocol/wire/codec.hpp"

namespace gabion::protocol {{

constexpr std::uint16_t protocol_version = {catalogue["version"]};

/// States of a session; see PROTOCOL.md.
enum class SessionState : std::uint8_t {{ {states} }};
std::string_view state_name(SessionState state);

{structs}

/// What the catalogue says of a message.
struct MessageInfo {{
  std::uint16_t id;
  std::string_view name;
  std::string_view from, to;  ///< coupler, engine, dem, continuum, either
  std::uint8_t states;        ///< bit 1 << SessionState where it may be sent
  std::uint16_t reply;        ///< id, 0 when there is none
  bool reconfigures;          ///< puts the engine back into configuring

  bool allowed_in(SessionState state) const {{ return (states >> static_cast<unsigned>(state) & 1u) != 0; }}
}};

/// In the order of the catalogue.
std::span<const MessageInfo> message_table();
/// nullptr when there is no such message.
const MessageInfo* find_message(std::uint16_t id);
/// "GAP", or "message 999" for an unknown one.
std::string message_name(std::uint16_t id);

/// Every message, in the order of the catalogue.
using AllMessages = std::tuple<{every}>;

}}  // namespace gabion::protocol
"""


def codec_text(message):
    name = type_name(message["name"])
    symbols, rules, puts, gets = {}, [], [], []
    for index, field in enumerate(message["fields"]):
        if field["type"] in ARRAYS:
            rules.append(f"constexpr ShapeRule {message['name'].lower()}_{field['name']}_rule"
                         f"{rule_text(message, field, symbols)};")
            rule = f"{message['name'].lower()}_{field['name']}_rule"
            puts.append(f"  writer.put({field['name']}, {rule}, sizes);")
            gets.append(f"  reader.get({field['name']}, {rule}, sizes);")
        else:
            puts.append(f"  writer.put({field['name']});")
            gets.append(f'  reader.get({field["name"]}, "{message["name"]}.{field["name"]}");')
    sizes = ["  Sizes sizes;"] if rules else []
    unused = "" if message["fields"] else "[[maybe_unused]] "
    lines = rules + [f"void {name}::encode({unused}Writer& writer) const {{"] + sizes + puts + ["}", ""]
    lines += [f"void {name}::decode(Reader& reader) {{"] + sizes + gets
    lines += [f'  reader.finish("{message["name"]}");', "}"]
    return "\n".join(lines)


def source_text(catalogue):
    ids = {m["name"]: m["id"] for m in catalogue["messages"]}
    rows = []
    for m in catalogue["messages"]:
        bits = sum(1 << catalogue["states"].index(s) for s in m["states"])
        reply = ids[m["reply"]] if "reply" in m else 0
        becomes = "true" if "becomes" in m else "false"
        rows.append(f'    {{{m["id"]}, "{m["name"]}", "{m["from"]}", "{m["to"]}", {bits}, {reply}, {becomes}}},')
    names = ", ".join(f'"{s}"' for s in catalogue["states"])
    bodies = "\n\n".join(codec_text(m) for m in catalogue["messages"])
    table = "\n".join(rows)
    return f"""// Generated from protocol/catalogue.json by protocol/generate.py.
#include "protocol/messages.hpp"

namespace gabion::protocol {{

{bodies}

namespace {{
constexpr MessageInfo table[] = {{
{table}
}};
constexpr std::string_view state_names[] = {{{names}}};
}}  // namespace

std::string_view state_name(SessionState state) {{ return state_names[static_cast<unsigned>(state)]; }}

std::span<const MessageInfo> message_table() {{ return table; }}

const MessageInfo* find_message(std::uint16_t id) {{
  for (const MessageInfo& info : table)
    if (info.id == id) return &info;
  return nullptr;
}}

std::string message_name(std::uint16_t id) {{
  const MessageInfo* info = find_message(id);
  return info ? std::string(info->name) : "message " + std::to_string(id);
}}

}}  // namespace gabion::protocol
"""


def write_if_changed(path, text):
    """Leaves the time stamp alone when nothing changed, so that nothing is compiled again."""
    if not path.exists() or path.read_text() != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


def summary_table(catalogue):
    lines = ["| id | message | from | to | states | reply |", "|---|---|---|---|---|---|"]
    for m in catalogue["messages"]:
        lines.append(f'| {m["id"]} | [{m["name"]}](#{m["name"].lower()}) | {m["from"]} | {m["to"]} | '
                     f'{", ".join(m["states"])} | {m.get("reply", "")} |')
    return "\n".join(lines)


def message_sections(catalogue):
    parts = []
    for m in catalogue["messages"]:
        lines = [f'#### {m["name"]}', "", f'Id {m["id"]}, from {m["from"]} to {m["to"]}, in '
                 f'{", ".join(m["states"])}' + (f'; reply {m["reply"]}' if "reply" in m else "") + ".", "", m["doc"]]
        if "becomes" in m:
            lines[2] = lines[2][:-1] + f'; becomes {m["becomes"]}.'
        if m["fields"]:
            lines += ["", "| field | type | shape | unit | meaning |", "|---|---|---|---|---|"]
            for f in m["fields"]:
                lines.append(f'| {f["name"]} | {f["type"]} | {f.get("shape", "")} | {f.get("unit", "")} | {f["doc"]} |')
        else:
            lines += ["", "No fields; the payload is empty."]
        parts.append("\n".join(lines))
    return "\n\n".join(parts)


def type_table(catalogue):
    lines = ["| type | bytes |", "|---|---|"]
    lines += [f"| {name} | {text} |" for name, text in catalogue["types"].items()]
    return "\n".join(lines)


def updated_docs(catalogue):
    text = DOCS.read_text()
    for marker, body in (("types", type_table(catalogue)), ("summary", summary_table(catalogue)),
                         ("messages", message_sections(catalogue))):
        pattern = re.compile(rf"(<!-- generated: {marker} -->\n).*?(<!-- end: {marker} -->)", re.S)
        if not pattern.search(text):
            raise CatalogueError(f"PROTOCOL.md has no markers for {marker}")
        text = pattern.sub(lambda found: found[1] + body + "\n" + found[2], text)
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    action = parser.add_mutually_exclusive_group(required=True)
    action.add_argument("--out", type=pathlib.Path, metavar="DIR")
    action.add_argument("--docs", action="store_true")
    action.add_argument("--check", action="store_true")
    arguments = parser.parse_args()
    try:
        catalogue = load()
        if arguments.out:
            write_if_changed(arguments.out / "messages.hpp", header_text(catalogue))
            write_if_changed(arguments.out / "messages.cpp", source_text(catalogue))
        elif arguments.docs:
            write_if_changed(DOCS, updated_docs(catalogue))
        elif updated_docs(catalogue) != DOCS.read_text():
            print("PROTOCOL.md does not match catalogue.json; run protocol/generate.py --docs", file=sys.stderr)
            return 1
    except CatalogueError as error:
        print(f"catalogue.json: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
