#!/usr/bin/env python3
"""Writes the tables of keys in docs/scenes.md from scenarios/scene.schema.json.

schema_doc.py           rewrites the part of the page between the two marks
schema_doc.py --check   ends with 1 when the page differs from the schema
"""
import json
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCHEMA = ROOT / "scenarios" / "scene.schema.json"
PAGE = ROOT / "docs" / "scenes.md"
BEGIN, END = "<!-- keys: begin -->", "<!-- keys: end -->"
BOUNDS = (("minimum", ">= "), ("exclusiveMinimum", "> "), ("maximum", "<= "), ("exclusiveMaximum", "< "))
# sections of the page: key, node; definitions that several keys share are shown once
SHARED = ("face", "pressure_history", "velocity_history")


class Tables:
    def __init__(self, schema):
        self.schema = schema
        self.lines = []

    def resolve(self, node):
        if "$ref" not in node:
            return node
        target = self.schema
        for step in node["$ref"].lstrip("#/").split("/"):
            target = target[step]
        return {**self.resolve(target), **{k: v for k, v in node.items() if k != "$ref"}}

    def value(self, node):
        """What may stand there, in words."""
        node = self.resolve(node)
        if "anyOf" in node:
            return " or ".join(dict.fromkeys(self.value(choice) for choice in node["anyOf"]))
        if "unit" in node:
            unit = "number" if node["unit"] == "1" else node["unit"]
            return unit + (" or infinite" if node.get("infinite") else "")
        if "enum" in node:
            return ", ".join(f"`{choice}`" for choice in node["enum"])
        if node["type"] == "array":
            items = node["items"]
            if isinstance(items, list):
                return "[" + ", ".join(self.value(item) for item in items) + "]"
            count = f"{node['minItems']} x " if node.get("minItems") == node.get("maxItems") and "minItems" in node else ""
            return f"[{count}{self.value(items)}]"
        if node["type"] == "object":
            required = node.get("required")
            return "{" + required[0] + " ...}" if required else "{...}"
        return {"string": "text", "boolean": "true, false", "integer": "whole number"}[node["type"]]

    def range(self, node):
        node = self.resolve(node)
        if "anyOf" in node:
            return " ".join(dict.fromkeys(filter(None, (self.range(choice) for choice in node["anyOf"]))))
        return ", ".join(f"{sign}{node[key]:g}" for key, sign in BOUNDS if key in node)

    def default(self, node, required):
        node = self.resolve(node)
        if required:
            return "required"
        return f"`{json.dumps(node['default'])}`" if "default" in node else ""

    def objects_in(self, node):
        """Objects that a value may be, behind lists and alternatives."""
        node = self.resolve(node)
        if "anyOf" in node:
            return [found for choice in node["anyOf"] for found in self.objects_in(choice)]
        if node.get("type") == "array" and not isinstance(node["items"], list):
            return self.objects_in(node["items"])
        return [node] if node.get("type") == "object" and "properties" in node else []

    def shares(self, node):
        """Name of the shared definition that a node refers to, directly or in an alternative."""
        if node.get("$ref", "").rsplit("/", 1)[-1] in SHARED:
            return node["$ref"].rsplit("/", 1)[-1]
        return next(filter(None, map(self.shares, node.get("anyOf", []))), None)

    def rows(self, node, prefix):
        for key, raw in node["properties"].items():
            path = f"{prefix}{key}"
            resolved = self.resolve(raw)
            shared = self.shares(raw)
            described = resolved.get("description", "")
            value = f"{self.value(raw)}" if not shared else f"[{shared.replace('_', ' ')}](#{shared.replace('_', '-')})"
            cells = [f"`{path}`", value, self.default(raw, key in node.get("required", [])), self.range(raw), described]
            self.lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
            if shared or path.endswith((".bridging", ".edge")):
                continue
            is_list = resolved.get("type") == "array"
            for inner in self.objects_in(raw):
                self.rows(inner, path + ("[]." if is_list else "."))
            if isinstance(resolved.get("additionalProperties"), dict):
                self.rows(self.resolve(resolved["additionalProperties"]), path + ".NAME.")

    def table(self, title, node, prefix=""):
        self.lines += ["", f"### {title}", ""]
        if node.get("description"):
            self.lines += [node["description"], ""]
        self.lines += ["| key | value | default | range (SI) | meaning |", "|---|---|---|---|---|"]
        if "properties" in node:
            self.rows(node, prefix)
        for choice in node.get("anyOf", []):
            choice = self.resolve(choice)
            if "properties" in choice:
                self.rows(choice, prefix)
            else:
                self.lines.append(f"| | {self.value(choice)} | | {self.range(choice)} | {choice.get('description', '')} |")

    def page(self):
        sections = {}
        for key, raw in self.schema["properties"].items():
            sections[key] = raw
        plain = {k: v for k, v in sections.items() if not self.nests(v)}
        self.table("Top level", {"properties": plain, "required": self.schema["required"]})
        for key, raw in sections.items():
            if self.nests(raw):
                self.table(key, {"properties": {key: raw}, "required": self.schema["required"]})
        for name in SHARED:
            self.table(name.replace("_", " "), self.schema["definitions"][name])
        return "\n".join(self.lines) + "\n"

    def nests(self, raw):
        node = self.resolve(raw)
        return bool(self.objects_in(node)) or isinstance(node.get("additionalProperties"), dict)


def main():
    tables = Tables(json.loads(SCHEMA.read_text())).page()
    text = PAGE.read_text()
    head, rest = text.split(BEGIN, 1)
    tail = rest.split(END, 1)[1]
    wanted = f"{head}{BEGIN}\n{tables}\n{END}{tail}"
    if "--check" in sys.argv[1:]:
        if wanted != text:
            sys.exit(f"{PAGE} does not match {SCHEMA}: run {pathlib.Path(__file__).name}")
        return
    PAGE.write_text(wanted)


if __name__ == "__main__":
    main()
