// A structure as faces and lines on a canvas: points move along the shape of the picked mode.

const SHADES = 16, LIGHT = [-0.35, -0.55, 0.76];

class Mesh extends Scene {
  constructor(canvas, parts, arrays) {
    super(canvas, parts, arrays);
    const points = arrays.points.data;
    const least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < points.length; i++) {
      least[i % 3] = Math.min(least[i % 3], points[i]);
      most[i % 3] = Math.max(most[i % 3], points[i]);
    }
    for (let i = 0; i < points.length; i++) points[i] += TARGET[i % 3] - (least[i % 3] + most[i % 3]) / 2;
    this.length = most[0] - least[0];
    this.coloured();
  }

  // Shades of each part's colour, from dark to light.
  coloured() {
    this.palette = known.parts.map((_, number) => {
      const hex = colour(`c${(number % 8) + 1}`), light = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
      return Array.from({ length: SHADES }, (_, i) => {
        const share = 0.55 + (0.65 * i) / (SHADES - 1);
        const mixed = light.map((c) => Math.round(share <= 1 ? c * share : c + (255 - c) * (share - 1) * 2));
        return `rgb(${mixed.join(" ")})`;
      });
    });
  }

  draw(points) {
    if (!this.width) return;
    const near = Math.abs(Math.cos(this.azimuth));
    this.zoom = Math.min(this.width / (5 + 0.95 * this.length * near), this.height / 6.2);
    this.pen.clearRect(0, 0, this.width, this.height);
    const count = points.length / 3, seen = new Array(count);
    for (let i = 0; i < count; i++) seen[i] = this.project(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
    const shapes = [];
    const { faces, lines } = this.arrays;
    for (let f = 0; f < (faces ? faces.shape[0] : 0); f++) {
      const [a, b, c, d, part] = row(faces, f);
      const corners = [a, b, c, d].map((i) => seen[i]);
      shapes.push({ corners, part, depth: mean(corners), shade: this.shade(points, a, b, c) });
    }
    for (let l = 0; l < (lines ? lines.shape[0] : 0); l++) {
      const [a, b, part] = row(lines, l);
      shapes.push({ corners: [seen[a], seen[b]], part, depth: mean([seen[a], seen[b]]) - 0.02 });
    }
    shapes.sort((one, other) => other.depth - one.depth);
    for (const shape of shapes) this.paint(shape);
  }

  // How much light a face gets, whichever of its sides is seen.
  shade(points, a, b, c) {
    const at = (i, k) => points[3 * i + k];
    const [u, v] = [b, c].map((i) => [0, 1, 2].map((k) => at(i, k) - at(a, k)));
    const normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    const size = Math.hypot(...normal) || 1;
    const light = Math.abs(normal.reduce((sum, n, k) => sum + n * LIGHT[k], 0)) / size;
    return Math.min(SHADES - 1, Math.floor(light * SHADES));
  }

  paint({ corners, part, shade }) {
    const pen = this.pen, shades = this.palette[part];
    pen.beginPath();
    corners.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    if (shade === undefined) {
      pen.strokeStyle = shades[0];
      pen.lineWidth = 1.6;
    } else {
      pen.closePath();
      pen.fillStyle = shades[shade];
      pen.fill();
      pen.strokeStyle = shades[Math.max(0, shade - 5)];
      pen.lineWidth = 0.5;
    }
    pen.stroke();
  }
}
