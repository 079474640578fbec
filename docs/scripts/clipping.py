"""Look at every page of the built documentation in a browser, and list what a reader cannot see whole.

    sphinx-build -b html docs OUT && python docs/scripts/clipping.py OUT [--width 390 ...] [--page start/python ...]

Needs Chromium, no driver and no network. Every page is loaded at three widths (phone, laptop, desk), in light and dark.
Listed is: text, formulas and pictures that stick out of the page or of what hides its overflow; words that run out of
their cell; formulas and, on a laptop or wider, tables that have to be scrolled; text with less contrast than 4.5 (WCAG
2.2, 1.4.3 AA; 3 where letters are large); letters that leave their own picture. The exit
code is 1 if anything is listed.

With --before LIST, an earlier output of this script, docs/tables/clipped.csv counts places before and now.
"""

import argparse
import collections
import http.server
import json
import shutil
import subprocess
import sys
import tempfile
import threading
from functools import partial
from pathlib import Path

from output import write_table

WIDTHS = (390, 1280, 1920)
THEMES = ("light", "dark")
#: In s, for all pages: beyond it the browser is taken to hang.
PATIENCE = 1800
NAME = "clipping-harness.html"

HARNESS = """<!doctype html><meta charset="utf-8"><title>clipping</title><body style="margin:0"><script>
const jobs = JOBS, themes = THEMES;
const SLACK = 1.5;  // px: what rounding to whole pixels moves

function name(el) {
  const inner = (el.innerText || el.textContent || el.getAttribute("src") || "").trim().replace(/\\s+/g, " ");
  return el.tagName.toLowerCase() + (el.className && el.className.split ? "." + el.className.split(/\\s+/)[0] : "")
    + ": " + Array.from(inner).slice(0, 60).join("");
}

let known;  // what was asked of each element in one look
function about(win, el) {
  if (!known.has(el)) {
    const style = win.getComputedStyle(el), box = el.getBoundingClientRect();
    known.set(el, {
      box, fixed: style.position === "fixed", flows: style.display === "inline" || style.display === "contents",
      x: style.overflowX, y: style.overflowY, colour: style.color, ground: style.backgroundColor,
      size: parseFloat(style.fontSize), weight: parseInt(style.fontWeight),
      hidden: style.visibility === "hidden" || style.display === "none" || style.opacity === "0"
        || (style.position === "absolute" && box.width <= 1.01 && box.height <= 1.01)  // for screen readers
        || el.classList.contains("skip-link") || el.id === "pst-skip-link"
        || Boolean(el.parentElement && about(win, el.parentElement).hidden),
    });
  }
  return known.get(el);
}

function check(win, el, box, found) {
  // How a box is cut off on its way out to the page.
  const page = win.document.documentElement.clientWidth, cuts = way => way === "hidden" || way === "clip";
  let x = true, y = true, wide = null;
  for (let at = el; at && at !== win.document.body; at = at.parentElement) {
    const one = about(win, at), out = one.box;
    if (one.flows) continue;
    const sideways = box.right > out.right + SLACK || box.left < out.left - SLACK;
    if (x && sideways && (at.tagName === "TD" || at.tagName === "TH")) found("runs out of its cell", at);
    if (x && one.x !== "visible") {
      if (sideways && cuts(one.x)) found("cut off", at);
      else if (sideways) wide = at;
      x = false;
    }
    if (y && one.y !== "visible") {
      if (cuts(one.y) && (box.bottom > out.bottom + SLACK || box.top < out.top - SLACK))
        found("cut off above or below", at);
      y = false;
    }
    if (one.fixed) return wide;
  }
  if (x && (box.right > page + SLACK || box.left < -SLACK)) found("out of the page", el);
  return wide;
}

function luminance([r, g, b]) {
  const f = v => (v /= 255) <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
  return 0.2126 * f(r) + 0.7152 * f(g) + 0.0722 * f(b);
}
const canvas = new OffscreenCanvas(1, 1).getContext("2d", {willReadFrequently: true});
const colours = new Map();
function rgba(text) {  // whatever notation a style sheet has
  if (!colours.has(text)) {
    canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = text; canvas.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = canvas.getImageData(0, 0, 1, 1).data;
    colours.set(text, [r, g, b, a / 255]);
  }
  return colours.get(text);
}
function contrast(win, el) {
  let layers = [];
  for (let at = el; at; at = at.parentElement) {
    const layer = rgba(about(win, at).ground);
    if (layer[3] > 0) layers.push(layer);
    if (layer[3] > 0.99) break;
  }
  let ground = [255, 255, 255];
  for (const [r, g, b, a] of layers.reverse()) ground = ground.map((v, k) => v * (1 - a) + [r, g, b][k] * a);
  const {colour, size, weight} = about(win, el), [r, g, b, a] = rgba(colour);
  const ink = ground.map((v, k) => v * (1 - a) + [r, g, b][k] * a);
  const [low, high] = [luminance(ink), luminance(ground)].sort((p, q) => p - q);
  const large = size >= 24 || (size >= 18.66 && weight >= 700);
  return (high + 0.05) / (low + 0.05) / (large ? 3 : 4.5);
}

function look(win, width) {
  known = new Map();
  const list = [], seen = new Set();
  const found = el => (what, at) => {
    const key = what + name(at);
    if (!seen.has(key)) { seen.add(key); list.push([what, name(at), name(el)]); }
  };
  const scroll = (wide, el) => {
    if (!wide) return;
    const formula = el.closest("math") && !el.closest("table");
    if (formula) found(el)("a formula has to be scrolled", wide);
    else if (width >= 1000 && el.closest("table")) found(el)("a table has to be scrolled", wide);
    else if (width >= 1000 && !el.closest("pre")) found(el)("has to be scrolled", wide);
  };
  const walker = win.document.createTreeWalker(win.document.body, NodeFilter.SHOW_TEXT);
  const range = win.document.createRange(), dim = new Set();
  for (let node; (node = walker.nextNode());) {
    const el = node.parentElement;
    if (!node.data.trim() || ["SCRIPT", "STYLE", "NOSCRIPT", "TEMPLATE"].includes(el.tagName)) continue;
    range.selectNodeContents(node);
    const boxes = [...range.getClientRects()].filter(box => box.width > 0.5 && box.height > 0.5);
    if (!boxes.length || about(win, el).hidden) continue;
    for (const box of boxes) scroll(check(win, el, box, found(el)), el);
    if (!el.closest("svg") && contrast(win, el) < 0.995) {
      const {colour} = about(win, el), key = colour + el.className;
      if (!dim.has(key)) { dim.add(key); found(el)("too little contrast: " + colour, el); }
    }
  }
  for (const el of win.document.querySelectorAll("img, svg, math, video, canvas")) {
    const box = el.getBoundingClientRect();
    if (box.width < 2 || about(win, el).hidden || el.parentElement.closest("svg")) continue;
    if (el.tagName === "IMG" && el.complete && !el.naturalWidth) found(el)("picture is missing", el);
    scroll(check(win, el, box, found(el)), el);
  }
  if (win.document.scrollingElement.scrollWidth > win.document.documentElement.clientWidth + SLACK)
    found(win.document.body)("the page has to be scrolled sideways", win.document.body);
  return list;
}

function drawing(win) {  // letters and lines of a picture that leave it
  const list = [], root = win.document.documentElement, frame = root.getBoundingClientRect();
  for (const el of root.querySelectorAll("text, g[id^='text_']")) {
    const box = el.getBoundingClientRect();
    if (!box.width) continue;
    if (box.left < frame.left - SLACK || box.right > frame.right + SLACK || box.top < frame.top - SLACK
        || box.bottom > frame.bottom + SLACK) list.push(["letters leave the picture", el.id || el.textContent, ""]);
  }
  return list;
}

const frames = n => new Promise(done => { const go = () => n-- ? setTimeout(go, 10) : done(); go(); });
(async () => {
  const frame = document.createElement("iframe");
  frame.style.cssText = "border:0;height:1200px";
  document.body.append(frame);
  for (const [url, width] of jobs) {
    frame.style.width = width + "px";
    await new Promise(done => { frame.onload = done; frame.src = url; });
    const win = frame.contentWindow, results = [];
    try {
      if (url.endsWith(".svg")) results.push(["", drawing(win)]);
      else for (const theme of themes) {
        win.document.documentElement.dataset.theme = theme;
        win.document.querySelectorAll("img[loading=lazy]").forEach(img => { img.loading = "eager"; });
        const still = win.document.createElement("style");  // colours that fade are measured when they have arrived
        still.textContent = "* { transition: none !important; animation: none !important }";
        win.document.head.append(still);
        await frames(2);
        results.push([theme, look(win, width)]);
      }
    } catch (error) { results.push(["", [["the page cannot be looked at", String(error), ""]]]); }
    await fetch("/", {method: "POST", body: JSON.stringify({url, width, results})});
  }
  await fetch("/", {method: "POST", body: "done"});
})();
</script>"""


class Handler(http.server.SimpleHTTPRequestHandler):
    """Serves the pages and the harness, and takes what the harness finds."""

    def __init__(self, *arguments, state, **options):
        self.state = state
        super().__init__(*arguments, **options)

    def do_GET(self):
        if self.path != f"/{NAME}":
            super().do_GET()
            return
        self.send_response(200)
        self.send_header("Content-Type", "text/html; charset=utf-8")
        self.end_headers()
        self.wfile.write(self.state["harness"].encode())

    def do_POST(self):
        body = self.rfile.read(int(self.headers["Content-Length"])).decode()
        self.send_response(204)
        self.end_headers()
        if body == "done":
            self.state["done"].set()
        else:
            self.state["found"].append(json.loads(body))

    def log_message(self, *_):
        pass


def look(folder, jobs, chromium):
    """Return what the browser finds: (page, width, theme, what, where, at which words)."""
    harness = HARNESS.replace("JOBS", json.dumps(jobs), 1).replace("THEMES", json.dumps(THEMES), 1)
    state = {"harness": harness, "done": threading.Event(), "found": []}
    server = http.server.ThreadingHTTPServer(
        ("127.0.0.1", 0), partial(Handler, directory=str(folder), state=state)
    )
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with tempfile.TemporaryDirectory() as profile:
        browser = subprocess.Popen(
            [
                *(chromium, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"),
                *(f"--user-data-dir={profile}", "--window-size=2000,1300"),
                "--remote-debugging-port=0",  # keeps the browser open
                f"http://127.0.0.1:{server.server_port}/{NAME}",
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            for _ in range(PATIENCE):
                if state["done"].wait(1) or browser.poll() is not None:
                    break
        finally:
            browser.terminate()
            browser.wait()
            server.shutdown()
            server.server_close()
    if not state["done"].is_set():
        raise SystemExit(
            f"the browser stopped after {len(state['found'])} of {len(jobs)} looks; try again with --page"
        )
    return [
        (job["url"], job["width"], theme, *row)
        for job in state["found"]
        for theme, rows in job["results"]
        for row in rows
    ]


def write_comparison(before, now):
    """Count places of a page by what is wrong with them."""

    def counted(rows):
        widths = collections.defaultdict(set)
        places = collections.defaultdict(set)
        for page, width, _, what, where, _ in rows:
            kind = what.partition(":")[0]
            key = (
                ("every page with source", kind)
                if page.startswith("_modules")
                else (page.removesuffix(".html"), kind)
            )
            widths[key].add(int(width))
            places[key].add((page, where))
        return widths, {key: len(found) for key, found in places.items()}

    widths, old = counted(before)
    _, new = counted(now)
    write_table(
        "clipped",
        ("page", "what", "widths before", "places before", "places now"),
        [
            (*key, " ".join(map(str, sorted(widths[key]))), old.get(key, 0), new.get(key, 0))
            for key in sorted({*old, *new})
        ],
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="what sphinx-build wrote")
    parser.add_argument("--width", type=int, action="append", help="in px; repeat for more")
    parser.add_argument("--page", action="append", help="without .html; repeat for more")
    parser.add_argument("--before", type=Path, help="a list that this script wrote earlier")
    parser.add_argument(
        "--chromium", default=shutil.which("chromium") or shutil.which("google-chrome")
    )
    requested = parser.parse_args()
    if not requested.chromium:
        parser.error("no Chromium on the path; name one with --chromium")
    made = sorted(
        path.relative_to(requested.folder).as_posix() for path in requested.folder.rglob("*.html")
    )
    pages = [path for path in made if not path.startswith(("_static", "_sources"))]
    if requested.page:
        pages = [f"{page}.html" for page in requested.page]
    if missing := [page for page in pages if not (requested.folder / page).is_file()]:
        parser.error(f"{requested.folder} has no {missing[0]}; build the pages first")
    jobs = [(f"/{page}", width) for width in requested.width or WIDTHS for page in pages]
    pictures = [] if requested.page else sorted((requested.folder / "_images").glob("*.svg"))
    jobs += [(f"/_images/{path.name}", 1280) for path in pictures]
    if not pages:
        parser.error(f"no pages in {requested.folder}")
    found = look(requested.folder.resolve(), jobs, requested.chromium)
    themes = collections.defaultdict(list)
    for page, width, theme, *row in found:
        themes[page, width, *row].append(theme)
    listed = [
        (page.lstrip("/"), str(width), "+".join(filter(None, seen)), *row)
        for (page, width, *row), seen in themes.items()
    ]
    for row in listed:
        print(*row, sep="\t")
    if requested.before:
        lines = requested.before.read_text(encoding="utf-8").splitlines()
        write_comparison([row for line in lines if (row := line.split("\t"))[0] in pages], listed)
    print(
        f"{len(pages)} pages at {len(requested.width or WIDTHS)} widths in {len(THEMES)} "
        f"themes, {len(pictures)} pictures:"
        f" {len(themes)} places",
        file=sys.stderr,
    )
    return bool(themes)


if __name__ == "__main__":
    sys.exit(main())
