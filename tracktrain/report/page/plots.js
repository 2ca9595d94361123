// Curves and spectra of the picked signals, one row of axes for each unit.

const PALETTE = ["c1", "c2", "c3", "c4", "c5", "c6", "c7", "c8"];
const MOST_PICKED = 12;
const KINDS = { derailment: "bad", "above Nadal": "c5", "wheel lift": "c4" }; // colours of events
const DEPTH = 1e-9; // of a spectrum below its peak, beyond which there is only rounding

const RUNS = known.runs ?? [""]; // names of those that lie over each other

// The colour of a picked signal of a run.
function paint(signal, run) {
  return PALETTE[(signal * RUNS.length + run) % PALETTE.length];
}

class Plots {
  constructor(arrays) {
    this.arrays = arrays;
    const names = known.signals.map(({ name }) => name);
    this.picked = known.first.map((name) => names.indexOf(name)).filter((number) => number >= 0);
    if (!this.picked.length) this.picked = [0];
    this.times = new Chart(document.getElementById("time-plot"), "Signals", "time [s]", {});
    const place = document.getElementById("spectrum-plot");
    if (place) this.spectra = new Chart(place, "Spectra", "frequency [Hz]", { logX: true, logY: true });
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
      const { name } = known.signals[number];
      const marks = RUNS.flatMap((run, r) => [element("span", { className: "mark", style: `background: var(--${paint(i, r)})` }), run && `${run} `]);
      const drop = () => {
        const box = document.querySelector(`#choices input[value="${number}"]`);
        box.checked = false;
        this.pick(number, box);
        document.getElementById("filter").focus();
      };
      return element("button", { type: "button", ariaLabel: `Remove ${name}`, onclick: drop }, ...marks, name, " ×");
    });
    document.getElementById("chips").replaceChildren(...chips);
    document.getElementById("picked").textContent = `${this.picked.length} of ${known.signals.length} picked${more && "; " + more}`;
  }

  draw() {
    const traces = (along, of, power) => this.picked.flatMap((number, i) => RUNS.map((run, r) => {
      const { name, unit, factor } = known.signals[number], after = run && String(r);
      const x = this.arrays[along + after].data, rows = this.arrays[of + after];
      const values = row(rows, number), floor = power > 1 ? DEPTH * values.reduce((a, b) => Math.max(a, b), 0) : -Infinity;
      const y = Float64Array.from(values, (value) => (value > floor ? value * factor ** power : NaN));
      const suffix = unit === "1" ? "" : power > 1 ? `(${unit})²/Hz` : unit;
      return { name: run ? `${name}, ${run}` : name, x, y, unit, suffix, colour: colour(paint(i, r)) };
    }));
    const bands = known.events.map(({ kind, from, to }) => ({ from, to, colour: colour(KINDS[kind]) }));
    this.times.set(traces("time", "signals", 1), (unit) => (unit === "1" ? "" : `[${unit}]`), bands);
    this.spectra.set(traces("frequency", "density", 2), (unit) => (unit === "1" ? "[1/Hz]" : `[(${unit})²/Hz]`));
  }

  // A line at the time that the car is shown at.
  mark(time) {
    this.times.mark(time);
  }
}
