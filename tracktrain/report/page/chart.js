// Curves over a common x, one row of axes for each unit: drawn, read off, zoomed, moved, saved.

const SVG = "http://www.w3.org/2000/svg";
const LEFT = 64, RIGHT = 14, TOP = 12, BOTTOM = 44, GAP = 16, FONT = 12;
const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";

function drawn(tag, attributes, ...children) {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

function power(exponent) {
  return `10${exponent < 0 ? "⁻" : ""}${[...String(Math.abs(exponent))].map((digit) => SUPERSCRIPT[digit]).join("")}`;
}

function decimal(value) {
  if (!value) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)) + 1e-9);
  if (exponent >= -3 && exponent < 5) return String(Number(value.toPrecision(8))).replace("-", "−");
  return `${Number((value / 10 ** exponent).toPrecision(4))}·${power(exponent)}`.replace("-", "−");
}

// Where an axis has marks, with their text; ends of a logarithmic one are exponents of ten.
function marks(low, high, count, log) {
  const raw = (high - low) / Math.max(count, 1);
  if (log && high - low > 1.2) {
    const step = Math.max(1, Math.ceil(raw)), found = [];
    for (let at = Math.ceil(low / step - 1e-9) * step; at <= high + 1e-9; at += step) found.push([at, power(at)]);
    return found;
  }
  if (log) {
    const found = [];
    for (let decade = Math.floor(low); decade <= high; decade++)
      for (const digit of [1, 2, 5]) {
        const at = decade + Math.log10(digit);
        if (at >= low && at <= high) found.push([at, decimal(digit * 10 ** decade)]);
      }
    return found;
  }
  const unit = 10 ** Math.floor(Math.log10(raw)), step = unit * [1, 2, 5, 10].find((n) => n * unit >= raw * 0.999);
  const found = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + 1e-9 * step; n++) found.push([n * step, decimal(Number((n * step).toPrecision(12)))]);
  return found.length > 1 || !(raw > 0) ? found : marks(low, high, 2 * Math.max(count, 1), log); // one mark is no scale
}

class Chart {
  // logX, logY: logarithmic axes. label: of the x axis.
  constructor(place, name, label, { logX = false, logY = false, height = 150 }) {
    Object.assign(this, { place, name, label, logX, logY, height, marked: null, span: null });
    const button = (text, title, onclick) => element("button", { type: "button", title, ariaLabel: `${title}: ${name}`, onclick }, text);
    this.view = element("div", { className: "chart", tabIndex: 0, role: "group", ariaLabel: `${name}. Plus and minus zoom, arrows move, 0 shows all.` });
    this.tip = element("div", { className: "tip", hidden: true });
    place.replaceChildren(
      element("div", { className: "tools" },
        button("+", "Zoom in", () => this.zoom(0.5)), button("−", "Zoom out", () => this.zoom(2)),
        button("All", "Show all", () => this.show(null)), button("Save", "Save as a picture", () => this.save())),
      this.view, this.tip);
    this.view.addEventListener("pointerdown", (event) => this.grab(event));
    this.view.addEventListener("pointermove", (event) => this.hover(event));
    this.view.addEventListener("pointerleave", () => this.leave());
    this.view.addEventListener("dblclick", () => this.show(null));
    this.view.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.width !== this.view.clientWidth && this.draw()).observe(this.view);
  }

  // traces: {name, x, y, unit, suffix, colour}; labels: text at the axes of a unit; bands: {from, to,
  // colour} along x.
  set(traces, labels, bands = []) {
    this.place.data = this.traces = traces;
    this.place.bands = this.bands = bands;
    this.labels = labels;
    this.units = [...new Set(traces.map(({ unit }) => unit))];
    const [lows, highs] = [Math.min, Math.max].map((most) => traces.map(({ x }) => most(this.along(x[this.logX && x[0] <= 0 ? 1 : 0]), this.along(x.at(-1)))));
    this.whole = traces.length ? [Math.min(...lows), Math.max(...highs)] : [0, 1];
    if (this.span && (this.span[0] >= this.whole[1] || this.span[1] <= this.whole[0])) this.span = null;
    this.draw();
  }

  along(x) { return this.logX ? Math.log10(x) : x; }
  up(y) { return this.logY ? Math.log10(y) : y; }
  get ends() { return this.span ?? this.whole; }
  get room() { return Math.max(this.width - LEFT - RIGHT, 10); }
  across(x) { return LEFT + ((this.along(x) - this.ends[0]) / (this.ends[1] - this.ends[0])) * this.room; }

  show(span) {
    if (span) {
      const size = Math.min(span[1] - span[0], this.whole[1] - this.whole[0]);
      const low = Math.min(Math.max(span[0], this.whole[0]), this.whole[1] - size);
      span = size < this.whole[1] - this.whole[0] ? [low, low + size] : null;
    }
    this.span = span;
    this.draw();
  }

  zoom(factor, middle = (this.ends[0] + this.ends[1]) / 2) {
    const half = ((this.ends[1] - this.ends[0]) * factor) / 2;
    this.show([middle - half, middle + half]);
  }

  move(share) {
    const way = (this.ends[1] - this.ends[0]) * share;
    this.show(this.ends.map((end) => end + way));
  }

  key(event) {
    const does = { "+": () => this.zoom(0.5), "=": () => this.zoom(0.5), "-": () => this.zoom(2), 0: () => this.show(null), ArrowLeft: () => this.move(-0.2), ArrowRight: () => this.move(0.2) }[event.key];
    if (!does || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    does();
  }

  draw() {
    if (!this.traces) return;
    this.width = this.view.clientWidth;
    const rows = Math.max(this.units.length, 1), tall = TOP + rows * (this.height + GAP) - GAP + BOTTOM;
    const ink = colour("ink"), muted = colour("muted"), grid = colour("line");
    const text = (x, y, said, more = {}) => drawn("text", { x, y, fill: muted, "text-anchor": "middle", ...more }, said);
    const svg = drawn("svg", { width: this.width, height: tall, viewBox: `0 0 ${this.width} ${tall}`, "font-size": FONT, "font-family": "system-ui, sans-serif", role: "img", "aria-label": this.name });
    const bottom = tall - BOTTOM;
    const along = marks(...this.ends, this.room / 90, this.logX).map(([at, said]) => [LEFT + ((at - this.ends[0]) / (this.ends[1] - this.ends[0])) * this.room, said]);
    for (const [x, said] of along) svg.append(text(x, bottom + 17, said));
    svg.append(text(LEFT + this.room / 2, tall - 8, this.label, { fill: ink }));
    const inside = (x) => Math.min(Math.max(this.across(x), LEFT), LEFT + this.room);
    for (const { from, to, colour: own } of this.bands)
      svg.append(drawn("rect", { class: "band", x: inside(from), width: Math.max(inside(to) - inside(from), 1), y: TOP, height: bottom - TOP, fill: own, "fill-opacity": 0.12 }));
    (this.units.length ? this.units : [""]).forEach((unit, row) => {
      const top = TOP + row * (this.height + GAP), own = this.traces.filter((trace) => trace.unit === unit);
      const [low, high] = this.bounds(own), place = (y) => top + this.height - ((y - low) / (high - low)) * this.height;
      for (const [x] of along) svg.append(drawn("line", { x1: x, x2: x, y1: top, y2: top + this.height, stroke: grid }));
      for (const [at, said] of marks(low, high, this.height / 32, this.logY)) {
        svg.append(drawn("line", { x1: LEFT, x2: LEFT + this.room, y1: place(at), y2: place(at), stroke: grid }));
        svg.append(text(LEFT - 7, place(at) + 4, said, { "text-anchor": "end" }));
      }
      svg.append(text(0, 0, this.labels(unit), { fill: ink, transform: `translate(12 ${top + this.height / 2}) rotate(-90)` }));
      const clip = drawn("svg", { x: LEFT, y: top, width: this.room, height: this.height, viewBox: `${LEFT} ${top} ${this.room} ${this.height}` });
      for (const trace of own) clip.append(drawn("path", { class: "curve", d: this.path(trace, place), fill: "none", stroke: trace.colour, "stroke-width": 1.4, "stroke-linejoin": "round" }));
      svg.append(clip);
    });
    this.line = drawn("line", { y1: TOP, y2: bottom, stroke: colour("accent"), visibility: "hidden" });
    this.cursor = drawn("line", { y1: TOP, y2: bottom, stroke: muted, "stroke-dasharray": "3 3", visibility: "hidden" });
    this.band = drawn("rect", { y: TOP, height: bottom - TOP, width: 0, fill: colour("accent"), "fill-opacity": 0.15 });
    svg.append(this.line, this.cursor, this.band);
    this.view.replaceChildren(svg);
    this.mark(this.marked);
  }

  // First and last number of a trace's points within the ends, one more at each side.
  within({ x }) {
    const [low, high] = this.ends.map((end) => (this.logX ? 10 ** end : end));
    const first = x.findIndex((value) => value >= low), last = x.findLastIndex((value) => value <= high);
    return [Math.max(first - 1, 0), Math.min(last + 1, x.length - 1)];
  }

  bounds(traces) {
    let low = Infinity, high = -Infinity;
    for (const trace of traces) {
      const [first, last] = this.within(trace);
      for (let i = first; i <= last; i++) {
        const y = this.up(trace.y[i]);
        if (!Number.isFinite(y)) continue;
        if (y < low) low = y;
        if (y > high) high = y;
      }
    }
    if (low > high) return [0, 1];
    const more = high > low ? 0.06 * (high - low) : Math.abs(high) || 1;
    return [low - more, high + more];
  }

  path(trace, place) {
    const [first, last] = this.within(trace), parts = [];
    let pen = "M";
    for (let i = first; i <= last; i++) {
      const x = this.across(trace.x[i]), y = place(this.up(trace.y[i]));
      if (Number.isFinite(x) && Number.isFinite(y)) {
        parts.push(`${pen}${x.toFixed(1)} ${y.toFixed(1)}`);
        pen = "L";
      } else pen = "M";
    }
    return parts.join("");
  }

  // A line at a value of x.
  mark(x) {
    this.marked = x;
    this.put(this.line, x);
  }

  put(line, x) {
    if (!line) return;
    const at = x === null ? NaN : this.across(x), seen = at >= LEFT - 0.5 && at <= LEFT + this.room + 0.5;
    line.setAttribute("visibility", seen ? "visible" : "hidden");
    if (seen) for (const end of ["x1", "x2"]) line.setAttribute(end, at);
  }

  at(event) { return event.clientX - this.view.getBoundingClientRect().left; }
  value(pixel) { return this.ends[0] + ((pixel - LEFT) / this.room) * (this.ends[1] - this.ends[0]); }

  // Drag to zoom; with the shift key to move.
  grab(event) {
    if (event.button || event.pointerType === "touch") return;
    const from = this.at(event), ends = this.ends;
    this.view.setPointerCapture(event.pointerId);
    const moved = (next) => {
      const to = this.at(next);
      if (event.shiftKey) {
        const way = ((from - to) / this.room) * (ends[1] - ends[0]);
        this.show(ends.map((end) => end + way));
        return;
      }
      this.band.setAttribute("x", Math.min(from, to));
      this.band.setAttribute("width", Math.abs(to - from));
    };
    const done = (next) => {
      this.view.removeEventListener("pointermove", moved);
      const to = this.at(next), [low, high] = [from, to].sort((a, b) => a - b);
      this.band.setAttribute("width", 0);
      if (!event.shiftKey && next.type === "pointerup" && high - low > 5) this.show([this.value(low), this.value(high)]);
    };
    this.view.addEventListener("pointermove", moved);
    for (const end of ["pointerup", "pointercancel"]) this.view.addEventListener(end, done, { once: true });
  }

  // Number of a trace's point that is nearest to a place along the axis.
  nearest(trace, wanted) {
    const { x } = trace;
    let [near] = this.within(trace);
    for (let i = near; i < x.length && this.along(x[i]) <= this.ends[1]; i++)
      if (Math.abs(this.along(x[i]) - wanted) < Math.abs(this.along(x[near]) - wanted) || !Number.isFinite(this.along(x[near]))) near = i;
    return near;
  }

  // All values at the point that is nearest.
  hover(event) {
    if (!this.traces?.length) return;
    const wanted = this.value(this.at(event)), own = this.traces.map((trace) => this.nearest(trace, wanted));
    const { x } = this.traces[0], near = own[0];
    this.put(this.cursor, x[near]);
    const lines = this.traces.map(({ name, y, suffix, colour }, n) => {
      const value = y[own[n]];
      const mark = element("span", { className: "mark" });
      mark.style.background = colour;
      return element("div", {}, mark, `${name}: ${Number.isFinite(value) ? decimal(Number(value.toPrecision(4))) : "–"} ${suffix}`);
    });
    this.tip.replaceChildren(element("strong", {}, `${this.label.split(" [")[0]} ${decimal(Number(x[near].toPrecision(5)))} ${this.label.split(/[[\]]/)[1] ?? ""}`), ...lines);
    this.tip.hidden = false;
    const box = this.place.getBoundingClientRect(), right = event.clientX - box.left, size = this.tip.offsetWidth;
    this.tip.style.left = `${Math.max(0, right + size + 24 < box.width ? right + 16 : right - size - 16)}px`;
    this.tip.style.top = `${Math.max(0, event.clientY - box.top - this.tip.offsetHeight / 2)}px`;
  }

  leave() {
    this.tip.hidden = true;
    this.put(this.cursor, null);
  }

  async save() {
    const svg = this.view.firstChild, copy = svg.cloneNode(true), [width, height] = ["width", "height"].map((side) => Number(svg.getAttribute(side)));
    copy.prepend(drawn("rect", { width, height, fill: colour("card") }));
    const picture = new Image(), canvas = element("canvas", { width: 2 * width, height: 2 * height });
    picture.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
    await picture.decode();
    canvas.getContext("2d").drawImage(picture, 0, 0, 2 * width, 2 * height);
    element("a", { href: canvas.toDataURL("image/png"), download: `${this.name.toLowerCase().replaceAll(" ", "_")}.png` }).click();
  }
}
