// Controls of a scene: play and pause, time, speed, amplification, views; by mouse, touch and keys.

class Player {
  // options: duration [s] of a cycle or a run, loops, speeds, speed, amplification {least, most, value}.
  constructor(scene, place, options, show) {
    Object.assign(this, { scene, options, show, time: 0, playing: false, speed: options.speed });
    this.controls(place);
    scene.redraw = () => this.frame();
    scene.canvas.addEventListener("keydown", (event) => this.key(event));
    this.frame();
  }

  controls(place) {
    const { options } = this, name = this.scene.canvas.id;
    this.button = element("button", { type: "button", className: "play", onclick: () => this.toggle() });
    this.clock = element("output", { className: "clock" });
    this.slider = element("input", { type: "range", min: 0, max: options.duration, step: options.duration / 1000, value: 0, ariaLabel: options.loops ? "Phase" : "Time" });
    this.slider.addEventListener("input", () => this.seek(Number(this.slider.value)));
    const speed = element("select", { id: `${name}-speed` }, ...options.speeds.map((factor) =>
      element("option", { value: factor, textContent: `${factor}×`, selected: factor === options.speed })));
    speed.addEventListener("change", () => (this.speed = Number(speed.value)));
    const { least, most, value } = options.amplification;
    this.factor = value;
    const gain = element("input", { type: "range", id: `${name}-gain`, min: Math.log10(least), max: Math.log10(most), step: 0.01, value: Math.log10(value) });
    const said = element("output");
    const amplify = () => {
      this.factor = 10 ** Number(gain.value);
      said.textContent = `${Number(this.factor.toPrecision(2))}×`;
      if (this.clock.textContent) this.frame();
    };
    gain.addEventListener("input", amplify);
    amplify();
    const views = element("div", { className: "views", role: "group", ariaLabel: "View" }, ...Object.keys(VIEWS).map((view) =>
      element("button", { type: "button", textContent: view, onclick: () => this.scene.look(view) })));
    place.append(
      this.button, element("span", { className: "timeline" }, this.slider, ...this.marks()), this.clock,
      element("label", { htmlFor: speed.id }, "speed ", speed),
      element("label", { htmlFor: gain.id }, "amplified ", gain, said),
      views);
    this.label();
  }

  // Events of the run under its slider.
  marks() {
    const { duration, start, loops } = this.options;
    return (loops ? [] : known.events).map(({ kind, place, from, to }) => {
      const mark = element("span", { className: "event", title: `${kind}: ${place}, ${from.toFixed(2)} s` });
      mark.style.left = `${(100 * (from - start)) / duration}%`;
      mark.style.width = `max(3px, ${(100 * (to - from)) / duration}%)`;
      mark.style.background = `var(--${KINDS[kind]})`;
      return mark;
    });
  }

  label() {
    this.button.textContent = this.playing ? "❚❚" : "▶";
    this.button.ariaLabel = this.playing ? "Pause" : "Play";
  }

  toggle() {
    this.playing = !this.playing;
    this.label();
    if (!this.playing) return;
    if (!this.options.loops && this.time >= this.options.duration) this.time = 0;
    let last = performance.now();
    const tick = (now) => {
      if (!this.playing) return;
      this.advance(((now - last) / 1000) * this.speed);
      last = now;
      requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  advance(step) {
    const { duration, loops } = this.options;
    let time = this.time + step;
    if (loops) time %= duration;
    else if (time >= duration) {
      time = duration;
      this.playing = false;
      this.label();
    }
    this.seek(time);
  }

  seek(time) {
    this.time = Math.max(0, Math.min(this.options.duration, time));
    this.slider.value = this.time;
    this.frame();
  }

  key(event) {
    const step = this.options.duration / 100;
    if (event.key === " ") this.toggle();
    else if (event.key === "ArrowRight") this.seek(this.time + step);
    else if (event.key === "ArrowLeft") this.seek(this.time - step);
    else if (event.key === "Home") this.seek(0);
    else if (event.key === "End") this.seek(this.options.duration);
    else return;
    event.preventDefault();
  }

  frame() {
    const said = this.show(this.time, this.factor);
    this.clock.textContent = said;
    if (!this.options.loops) this.slider.setAttribute("aria-valuetext", said);
  }
}

// The run: its coordinates, and the rails that the leading axle felt when it was there.
function runPlayer(arrays, whenMoved) {
  const { step, start, firstAxle } = known.scene;
  const scene = new Scene(document.getElementById("car"), known.scene, arrays);
  const way = arrays.way.data, count = way.length, width = arrays.coordinates.shape[1];
  const now = new Float64Array(width);

  const between = (data, width, column, place) => {
    const i = Math.max(0, Math.min(count - 2, Math.floor(place))), share = Math.min(Math.max(place - i, 0), 1);
    return data[i * width + column] * (1 - share) + data[(i + 1) * width + column] * share;
  };
  // Frame at which the leading axle was at a distance, by bisection.
  const frameAt = (distance) => {
    let [low, high] = [0, count - 1];
    if (distance <= way[0]) return 0;
    if (distance >= way[high]) return high;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (way[middle] <= distance) low = middle;
      else high = middle;
    }
    return low + (distance - way[low]) / Math.max(way[high] - way[low], 1e-9);
  };
  const show = (time, factor) => {
    const place = time / step;
    for (let c = 0; c < width; c++) now[c] = between(arrays.coordinates.data, width, c, place);
    const here = between(way, 1, 0, place);
    const rails = (x, side) => {
      const at = frameAt(here + x - firstAxle), ahead = here + x - firstAxle;
      if (ahead < way[0]) return [0, 0];
      return [side, side + 2].map((column) => factor * between(arrays.rails.data, 4, column, at));
    };
    scene.draw(scene.place(now, factor), rails, here);
    whenMoved(start + time);
    return `${(start + time).toFixed(2)} s`;
  };
  const amplification = { least: 1, most: 1000, value: sensible(arrays) };
  const options = { start, duration: step * (count - 1), loops: false, speeds: [0.1, 0.25, 0.5, 1, 2], speed: 0.5, amplification };
  return new Player(scene, document.getElementById("car-controls"), options, show);
}

// Amplification at which the largest displacement is 0.4 m.
function sensible(arrays) {
  const { coordinates, motions } = arrays, width = coordinates.shape[1];
  let most = 1e-6;
  for (let c = 0; c < width; c++) {
    let peak = 0, reach = 0;
    for (let i = c; i < coordinates.data.length; i += width) peak = Math.max(peak, Math.abs(coordinates.data[i]));
    for (const value of row(motions, c)) reach = Math.max(reach, Math.abs(value));
    most = Math.max(most, peak * reach);
  }
  return Math.max(1, Math.min(500, Number((0.4 / most).toPrecision(1))));
}

// The linear modes: one cycle of the picked one, again and again.
function modePlayer(arrays) {
  const scene = new Scene(document.getElementById("mode"), known.scene, arrays);
  const now = new Float64Array(arrays.modes.shape[2]);
  let picked = 0, size = 1, lag = 0;
  const pick = (number) => {
    picked = number;
    const [re, im] = shape();
    size = 0;
    for (let i = 0; i < arrays.points.data.length; i++) {
      let [a, b] = [0, 0];
      for (let c = 0; c < now.length; c++) {
        a += re[c] * row(arrays.motions, c)[i];
        b += im[c] * row(arrays.motions, c)[i];
      }
      if (Math.hypot(a, b) > size) [size, lag] = [Math.hypot(a, b), Math.atan2(b, a)];
    }
  };
  const shape = () => {
    const both = row(arrays.modes, picked);
    return [both.subarray(0, now.length), both.subarray(now.length)];
  };
  const show = (phase, factor) => {
    const [re, im] = shape(), angle = 2 * Math.PI * phase - lag;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    for (let i = 0; i < now.length; i++) now[i] = (re[i] * c - im[i] * s) / size;
    scene.draw(scene.place(now, factor), () => [0, 0], 0);
    return `${Math.round(360 * phase)}°`;
  };
  pick(0);
  const options = { duration: 1, loops: true, speeds: [0.25, 0.5, 1, 2], speed: 0.5, amplification: { least: 0.05, most: 2, value: 0.6 } };
  const player = new Player(scene, document.getElementById("mode-controls"), options, show);
  const choices = known.modes.map(({ name, frequency, damping }, number) => {
    const input = element("input", { type: "radio", name: "mode", value: number, checked: number === 0 });
    input.addEventListener("change", () => { pick(number); player.frame(); });
    const numbers = element("small", { className: damping < 0 ? "grows" : "" }, `${frequency.toFixed(2)} Hz, damping ${damping.toFixed(3)}`);
    return element("label", {}, input, element("span", {}, name, numbers));
  });
  document.getElementById("mode-choices").append(...choices);
  return player;
}
