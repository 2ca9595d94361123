// Curves and spectra of the picked signals, one row of axes for each unit.

const PALETTE = ["c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8"];
const BUTTONS = [["zoom2d", "pan2d"], ["zoomIn2d", "zoomOut2d", "resetScale2d"], ["toImage"]];
const MOST_PICKED = 12;
const KINDS = { derailment: "bad", "above Nadal": "c5", "wheel lift": "c4" }; // colours of events
const DEPTH = 1e-9; // of a spectrum below its peak, beyond which there is only rounding

class Plots {
  constructor(arrays) {
    this.arrays = arrays;
    const names = known.signals.map(({ name }) => name);
    this.picked = known.first.map((name) => names.indexOf(name)).filter((number) => number >= 0);
    if (!this.picked.length) this.picked = [0];
    this.choices();
    document.getElementById("filter").addEventListener("input", (event) => this.filter(event.target.value));
  }

  choices() {
    const groups = new Map();
    known.signals.forEach((signal, number) => {
      const [instance] = signal.name.split(".", 1);
      if (!groups.has(instance)) groups.set(instance, []);
      groups.get(instance).push({ ...signal, number });
    });
    const place = document.getElementById("choices");
    for (const [instance, signals] of groups) {
      const boxes = signals.map(({ name, text, number }) => {
        const box = element("input", { type: "checkbox", value: number, checked: this.picked.includes(number) });
        box.addEventListener("change", () => this.pick(number, box));
        return element("label", { title: text }, box, element("span", {}, name.slice(instance.length + 1) || name));
      });
      const open = signals.some(({ number }) => this.picked.includes(number));
      place.append(element("details", { open }, element("summary", {}, instance), ...boxes));
    }
    this.say();
  }

  filter(text) {
    const words = text.toLowerCase().split(/\s+/).filter(Boolean);
    for (const group of document.querySelectorAll("#choices details")) {
      let any = false;
      for (const label of group.querySelectorAll("label")) {
        const { name, text: meaning } = known.signals[Number(label.querySelector("input").value)];
        const found = words.every((word) => `${name} ${meaning}`.toLowerCase().includes(word));
        label.hidden = !found;
        any ||= found;
      }
      group.hidden = !any;
      group.open = words.length ? any : group.querySelector("input:checked") !== null;
    }
  }

  pick(number, box) {
    if (box.checked && this.picked.length >= MOST_PICKED) {
      box.checked = false;
      this.say(`no more than ${MOST_PICKED} at a time`);
      return;
    }
    this.picked = box.checked ? [...this.picked, number] : this.picked.filter((other) => other !== number);
    this.say();
    this.draw();
  }

  say(more = "") {
    const chips = this.picked.map((number, i) => {
      const { name } = known.signals[number], mark = element("span", { className: "mark" });
      mark.style.background = `var(--${PALETTE[i % PALETTE.length]})`;
      const drop = () => {
        const box = document.querySelector(`#choices input[value="${number}"]`);
        box.checked = false;
        this.pick(number, box);
        document.getElementById("filter").focus();
      };
      return element("button", { type: "button", ariaLabel: `Remove ${name}`, onclick: drop }, mark, name, " ×");
    });
    document.getElementById("chips").replaceChildren(...chips);
    document.getElementById("picked").textContent = `${this.picked.length} of ${known.signals.length} picked${more && "; " + more}`;
  }

  // A row of axes for each unit, from the top.
  layout(units, title, labels, height) {
    const ink = colour("ink"), grid = colour("line"), rows = Math.max(units.length, 1);
    const axis = { gridcolor: grid, zerolinecolor: grid, linecolor: grid, automargin: true, tickfont: { size: 11 } };
    const layout = {
      height: 120 + height * rows, margin: { l: 62, r: 12, t: 30, b: 44 },
      paper_bgcolor: "transparent", plot_bgcolor: "transparent",
      font: { family: "system-ui, sans-serif", color: ink, size: 12 },
      hovermode: "x unified", hoverlabel: { bgcolor: colour("card"), bordercolor: grid, font: { color: ink } },
      showlegend: false, modebar: { bgcolor: "transparent", color: colour("muted"), activecolor: colour("accent") },
      xaxis: { ...axis, title: { text: title }, anchor: rows > 1 ? `y${rows}` : "y", ...labels.x },
    };
    units.forEach((unit, i) => {
      const gap = 0.05, size = (1 - gap * (rows - 1)) / rows, top = 1 - i * (size + gap);
      layout[i ? `yaxis${i + 1}` : "yaxis"] = { ...axis, domain: [Math.max(top - size, 0), top], title: { text: labels.y(unit), font: { size: 11 } }, ...labels.yaxis };
    });
    return layout;
  }

  draw() {
    const { time, signals, frequency, density } = this.arrays;
    const units = [...new Set(this.picked.map((number) => known.signals[number].unit))];
    const traces = (x, rows, power) => this.picked.map((number, i) => {
      const { name, unit, factor } = known.signals[number], place = units.indexOf(unit);
      const values = row(rows, number), floor = power > 1 ? DEPTH * values.reduce((a, b) => Math.max(a, b), 0) : -Infinity;
      const y = Float64Array.from(values, (value) => (value > floor ? value * factor ** power : NaN));
      const shown = y.findLastIndex((value) => !Number.isNaN(value)) + 1;
      return { x: x.subarray(0, shown), y: y.subarray(0, shown), name, type: "scatter", mode: "lines", xaxis: "x", yaxis: place ? `y${place + 1}` : "y",
        line: { color: colour(PALETTE[i % PALETTE.length]), width: 1.3 }, hovertemplate: `%{y:.4g} ${unit === "1" ? "" : unit}${power > 1 ? "²/Hz" : ""}` };
    });
    const config = { responsive: true, displaylogo: false, modeBarButtons: BUTTONS };
    const own = (unit) => (unit === "1" ? "" : `[${unit}]`);
    const layout = this.layout(units, "time [s]", { x: { range: [time.data[0], time.data.at(-1)] }, y: own, yaxis: {} }, 150);
    this.events = known.events.map(({ kind, from, to }) => ({
      type: "rect", layer: "below", xref: "x", yref: "paper", x0: from, x1: to, y0: 0, y1: 1,
      fillcolor: colour(KINDS[kind]), opacity: 0.12, line: { color: colour(KINDS[kind]), width: 1 } }));
    Plotly.react("time-plot", traces(time.data, signals, 1), { ...layout, shapes: this.events }, config);
    const per = (unit) => (unit === "1" ? "[1/Hz]" : `[(${unit})²/Hz]`);
    Plotly.react("spectrum-plot", traces(frequency.data, density, 2),
      this.layout(units, "frequency [Hz]", { x: { type: "log" }, y: per, yaxis: { type: "log", exponentformat: "power", nticks: 5 } }, 150), config);
  }

  // A line at the time that the car is shown at.
  mark(time) {
    if (!document.getElementById("time-plot").layout) return;
    const line = { type: "line", xref: "x", yref: "paper", x0: time, x1: time, y0: 0, y1: 1, line: { color: colour("accent"), width: 1 } };
    Plotly.relayout("time-plot", { shapes: [...this.events, line] });
  }
}
