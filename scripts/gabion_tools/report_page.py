"""report.html: one file with everything in it. Run as a program: FOLDER. Standard library only."""

import base64
import html
import sys
from pathlib import Path

from gabion_tools import summary

STYLE = """body{font:15px/1.5 system-ui,sans-serif;max-width:62em;margin:2em auto;padding:0 1em;color:#222}
h1{font-size:1.5em}h2{font-size:1.15em;margin-top:2em;border-bottom:1px solid #ddd}
table{border-collapse:collapse}td{padding:.15em 1em .15em 0;vertical-align:top;border-bottom:1px solid #eee}
td:first-child{color:#555;white-space:nowrap}td+td{font-variant-numeric:tabular-nums;overflow-wrap:anywhere}
img{max-width:100%}pre{background:#f6f6f6;padding:.8em;overflow:auto;font-size:12.5px}
.warning{background:#fff3d6;border-left:4px solid #e0a000;padding:.4em .8em;margin:.4em 0}"""

CAPTIONS = {"energy": "Energies", "probes": "Probes", "stress": "Stress and strain", "block": "Block",
            "reactions": "Reactions", "monitor": "Convergence", "section": "Section", "crater": "Crater", "interface": "Interface"}
LOG_LINES = 60


def image(path):
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f'<img alt="{html.escape(path.stem)}" src="data:image/png;base64,{data}">'


def page(title, parts):
    return (f"<!doctype html><html lang='en'><head><meta charset='utf-8'><title>{html.escape(title)}</title>"
            f"<style>{STYLE}</style></head><body><h1>{html.escape(title)}</h1>{''.join(parts)}</body></html>\n")


def table(pairs):
    rows = "".join(f"<tr><td>{html.escape(a)}</td><td>{html.escape(b)}</td></tr>" for a, b in pairs)
    return f"<table>{rows}</table>"


def details(title, path, lines=None):
    if not path.exists():
        return ""
    text = path.read_text(encoding="utf-8", errors="replace")
    if lines:
        text = "\n".join(text.splitlines()[-lines:])
    return f"<details><summary>{html.escape(title)}</summary><pre>{html.escape(text)}</pre></details>"


def write(folder):
    """Writes folder/report.html from summary.json, plots/, the effective scene and the log."""
    content = summary.load(folder)
    pairs = list(summary.rows(content))
    parts = [f"<div class='warning'>{html.escape(text)}</div>" for name, text in pairs if name == "warning"]
    parts += ["<h2>Summary</h2>", table(pair for pair in pairs if pair[0] != "warning")]
    order = list(CAPTIONS)
    drawn = sorted((folder / "plots").glob("*.png"),
                   key=lambda p: (order.index(p.stem) if p.stem in order else len(order), p.stem))
    for path in drawn:
        parts.append(f"<h2>{html.escape(CAPTIONS.get(path.stem, path.stem))}</h2>{image(path)}")
    parts += ["<h2>Files</h2>", details("Effective scene", folder / "scene.effective.json"),
              details("End of the log", folder / "run.log", LOG_LINES)]
    title = content.get("title") or content.get("scene") or folder.name
    (folder / "report.html").write_text(page(f"{title} ({content.get('model', '')})", parts), encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
