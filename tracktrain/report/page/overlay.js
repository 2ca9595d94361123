// Runs over each other.

unpacked().then((arrays) => {
  const plots = new Plots(arrays);
  plots.draw();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => plots.draw());
  document.documentElement.dataset.ready = "yes";
});
