// The page of a structure's modes: one cycle of the picked one, again and again.

async function begin() {
  const arrays = await unpacked();
  const scene = new Mesh(document.getElementById("mode"), known.parts, arrays);
  const now = new Float64Array(known.modes.length);
  let picked = 0;
  const show = (phase, factor) => {
    now.fill(0);
    now[picked] = Math.sin(2 * Math.PI * phase);
    scene.draw(scene.place(now, factor));
    return `${Math.round(360 * phase)}°`;
  };
  const options = { duration: 1, loops: true, speeds: [0.25, 0.5, 1, 2], speed: 0.5, amplification: { least: 0.05, most: 2, value: 0.5 } };
  const player = new Player(scene, document.getElementById("mode-controls"), options, show);
  player.seek(0.25);
  whenSpace(() => player.toggle());
  const choices = known.modes.map(({ name, said }, number) => {
    const input = element("input", { type: "radio", name: "mode", value: number, checked: number === 0 });
    input.addEventListener("change", () => { picked = number; player.frame(); });
    return element("label", {}, input, element("span", {}, name, element("small", {}, said)));
  });
  document.getElementById("mode-choices").append(...choices);
  const legend = known.parts.map((name, number) =>
    element("span", {}, element("span", { className: "mark", style: `background: var(--c${(number % 8) + 1})` }), name));
  document.getElementById("parts").append(...legend);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { scene.coloured(); player.frame(); });
  document.documentElement.dataset.ready = "yes";
}

begin().catch((error) => {
  document.getElementById("broken").hidden = false;
  console.error(error);
});
