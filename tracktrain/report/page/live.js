// A run under way: the curves of the picked signals, sent by the run a few times a second.

class LivePlots extends Plots {
  constructor() {
    super(null);
    this.told = null;
    this.held = false;
    this.listen();
  }

  // Hear of the signals that are picked now.
  listen() {
    this.source?.close();
    const asked = this.picked.map((number) => `of=${encodeURIComponent(known.signals[number].name)}`);
    this.source = new EventSource(`/messages?${asked.join("&")}`);
    this.source.addEventListener("now", ({ data }) => this.hear(JSON.parse(data), "Running"));
    this.source.addEventListener("end", ({ data }) => {
      this.source.close();
      this.over = true;
      const told = JSON.parse(data);
      this.hear(told, told.said ? "Stopped" : "Ended");
    });
    this.source.onerror = () => {
      this.source.close();
      if (!this.over) this.state("Gone", "the run no longer answers.");
    };
  }

  pick(number, box) {
    super.pick(number, box);
    if (!this.over) this.listen();
  }

  hear(told, state) {
    const { time, start, stop, speed, rows, said } = told;
    this.state(state, said || (this.over ? "this page keeps the last values until it is closed; the results are where the terminal says." : this.held ? "; the curves are held." : "."));
    const share = stop > start ? (time - start) / (stop - start) : 1;
    document.getElementById("progress").value = share;
    document.getElementById("time").textContent = `${time.toFixed(2)} s`;
    document.getElementById("of").textContent = `of ${decimal(Number(stop.toPrecision(6)))} s`;
    document.getElementById("speed").textContent = `${Number(speed.toPrecision(3))}×`;
    document.getElementById("rows").textContent = rows.toLocaleString("en");
    if (this.held && !this.over) return;
    this.told = told;
    this.draw();
  }

  state(word, more) {
    document.getElementById("state").replaceChildren(element("strong", {}, word), more.startsWith(".") || more.startsWith(";") ? more : `: ${more}`);
  }

  draw() {
    const curves = this.told?.curves ?? {};
    const shown = this.picked.map((number, i) => ({ name: known.signals[number].name, place: i })).filter(({ name }) => curves[name]);
    const traces = shown.map(({ name, place }) => {
      const { x, y, unit } = curves[name];
      return { name, x, y: y.map((value) => value ?? NaN), unit, suffix: unit === "1" ? "" : unit, colour: colour(PALETTE[place % PALETTE.length]) };
    });
    if (traces.length) this.times.set(traces, (unit) => (unit === "1" ? "" : `[${unit}]`));
    const rows = shown.map(({ name }) => {
      const { y, unit, least, largest } = curves[name];
      const number = (value) => element("td", { className: "number" }, value === null ? "–" : decimal(Number(value.toPrecision(4))));
      return element("tr", {}, element("th", { scope: "row" }, element("code", {}, name)), number(y.at(-1)), number(least), number(largest), element("td", {}, unit === "1" ? "" : unit));
    });
    document.getElementById("numbers").replaceChildren(...rows);
  }
}

const plots = new LivePlots();
whenSpace(() => (plots.held = !plots.held));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.draw());
document.documentElement.dataset.ready = "yes";
