// The car as a wire frame on a canvas: points move linearly with the coordinates.

const VIEWS = { "3/4": [-0.62, 0.3], side: [0, 0.06], front: [-1.5708, 0.1], top: [0, 1.5] };
const COLOURS = { carbody: "body", bolster: "bolster", "side frame": "frame", wheelset: "wheel" };
const DISTANCE = 26, TARGET = [0, 0, 0.75], SLEEPERS = 0.6, REACH = 9.6, RAIL_POINTS = 65;

class Scene {
  constructor(canvas, drawing, arrays) {
    Object.assign(this, { canvas, drawing, arrays });
    this.pen = canvas.getContext("2d");
    this.moved = new Float64Array(arrays.points.data.length);
    [this.azimuth, this.elevation] = VIEWS["3/4"];
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => this.turn(event));
  }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    this.width = this.canvas.clientWidth;
    this.height = this.canvas.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.redraw?.();
  }

  turn(down) {
    this.canvas.setPointerCapture(down.pointerId);
    let [x, y] = [down.clientX, down.clientY];
    const move = (event) => {
      this.azimuth -= (event.clientX - x) * 0.008;
      this.elevation = Math.max(-0.1, Math.min(1.55, this.elevation + (event.clientY - y) * 0.008));
      [x, y] = [event.clientX, event.clientY];
      this.redraw?.();
    };
    this.canvas.addEventListener("pointermove", move);
    const stop = () => this.canvas.removeEventListener("pointermove", move);
    for (const end of ["pointerup", "pointercancel"]) this.canvas.addEventListener(end, stop, { once: true });
  }

  look(view) {
    [this.azimuth, this.elevation] = VIEWS[view];
    this.redraw?.();
  }

  // Points of the frame where the coordinates, times a factor, take them.
  place(coordinates, factor) {
    this.moved.set(this.arrays.points.data);
    for (let c = 0; c < coordinates.length; c++) {
      const motion = row(this.arrays.motions, c), q = coordinates[c] * factor;
      if (q) for (let i = 0; i < motion.length; i++) this.moved[i] += q * motion[i];
    }
    return this.moved;
  }

  project(x, y, z) {
    const [ca, sa] = [Math.cos(this.azimuth), Math.sin(this.azimuth)];
    const [ce, se] = [Math.cos(this.elevation), Math.sin(this.elevation)];
    [x, y, z] = [x - TARGET[0], y - TARGET[1], z - TARGET[2]];
    const right = ca * x + sa * y, away = -sa * x + ca * y;
    const depth = DISTANCE + ce * away - se * z;
    const scale = (this.zoom * DISTANCE) / depth;
    return [this.width / 2 + scale * right, this.height / 2 - scale * (se * away + ce * z), depth];
  }

  // points: x, y, z of the frame's points; rails: displacement at a place of [left, right].
  draw(points, rails, way) {
    if (!this.width) return;
    const near = Math.abs(Math.cos(this.azimuth));
    this.zoom = Math.min(this.width / (5 + 12.4 * near), this.height / 6.2);
    this.pen.clearRect(0, 0, this.width, this.height);
    this.track(rails, way);
    const shapes = [];
    let first = 0;
    const bodies = [];
    for (const { part, count } of this.drawing.lines) {
      const line = [];
      for (let i = first; i < first + count; i++)
        line.push(this.project(points[3 * i], points[3 * i + 1], points[3 * i + 2]));
      first += count;
      if (part === "carbody") bodies.push(line);
      shapes.push({ line, part, depth: mean(line) - (part === "carbody" ? 0 : 0.01) });
    }
    if (this.drawing.panels) shapes.push(...this.panels(bodies));
    shapes.sort((a, b) => b.depth - a.depth);
    for (const shape of shapes) this.paint(shape);
  }

  // The carbody's sides, between its four longest lines.
  panels(lines) {
    const most = Math.max(...lines.map((line) => line.length));
    const edges = lines.filter((line) => line.length === most);
    const found = [];
    edges.forEach((edge, number) => {
      if (number === 2) return; // an open hopper
      const next = edges[(number + 1) % edges.length];
      for (let i = 0; i + 1 < most; i++)
        found.push([edge[i], edge[i + 1], next[i + 1], next[i]]);
    });
    for (const i of [0, most - 1]) found.push(edges.map((edge) => edge[i]));
    return found.map((line) => ({ line, part: "panel", depth: mean(line) + 0.02 }));
  }

  paint({ line, part }) {
    this.pen.beginPath();
    line.forEach(([x, y], i) => (i ? this.pen.lineTo(x, y) : this.pen.moveTo(x, y)));
    if (part === "panel") {
      this.pen.fillStyle = colour("panel");
      this.pen.fill();
      return;
    }
    if (part === "wheelset" && line.length > 2) {
      this.pen.fillStyle = colour("disc");
      this.pen.fill();
    }
    this.pen.strokeStyle = colour(COLOURS[part]);
    this.pen.lineWidth = (part === "carbody" ? 1.4 : 3) * Math.min(Math.max(this.zoom / 55, 0.5), 1);
    this.pen.lineJoin = this.pen.lineCap = "round";
    this.pen.stroke();
  }

  track(rails, way) {
    const pen = this.pen, { railHeight, halfGauge } = this.drawing;
    pen.lineWidth = 5 * Math.min(this.zoom / 60, 1);
    pen.strokeStyle = colour("sleeper");
    const offset = -(((way % SLEEPERS) + SLEEPERS) % SLEEPERS);
    for (let x = -REACH; x <= REACH; x += SLEEPERS) {
      const at = x + offset;
      if (at < -REACH) continue;
      const [a, b] = [-1.3, 1.3].map((y) => this.project(at, y, railHeight - 0.12));
      pen.beginPath();
      pen.moveTo(a[0], a[1]);
      pen.lineTo(b[0], b[1]);
      pen.stroke();
    }
    pen.lineWidth = 2;
    pen.strokeStyle = colour("rail");
    for (const side of [0, 1]) {
      pen.beginPath();
      for (let i = 0; i < RAIL_POINTS; i++) {
        const x = -REACH + (2 * REACH * i) / (RAIL_POINTS - 1), [y, z] = rails(x, side);
        const at = this.project(x, (side ? -1 : 1) * halfGauge + y, railHeight + z);
        if (i) pen.lineTo(at[0], at[1]);
        else pen.moveTo(at[0], at[1]);
      }
      pen.stroke();
    }
  }
}

function mean(line) {
  return line.reduce((sum, point) => sum + point[2], 0) / line.length;
}
