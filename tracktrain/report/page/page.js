// Starts everything; what the run does not have is left out.

async function begin() {
  for (const part of document.querySelectorAll("[data-needs]"))
    if (!known[part.dataset.needs]) part.remove();
  const arrays = await unpacked();
  let plots = null, marked = 0;
  const players = [];
  const whenMoved = (time) => {
    if (!plots || performance.now() - marked < 100) return;
    marked = performance.now();
    plots.mark(time);
  };
  if (known.scene) players.push(runPlayer(arrays, whenMoved));
  for (const button of document.querySelectorAll("button.seek")) {
    button.disabled = !players.length;
    button.addEventListener("click", () => {
      players[0].seek(Number(button.dataset.time) - known.scene.start);
      document.getElementById("motion").scrollIntoView();
    });
  }
  if (known.modes) players.push(modePlayer(arrays));
  if (players.length) whenSpace(() => players[0].toggle());
  plots = new Plots(arrays);
  plots.draw();
  const redraw = () => {
    plots.draw();
    for (const player of players) player.frame();
  };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  document.documentElement.dataset.ready = "yes";
}

begin().catch((error) => {
  document.getElementById("broken").hidden = false;
  console.error(error);
});
