// Keys that work wherever the focus is, and tables that are sorted by a press on a heading.

// Space anywhere but where it types, presses or opens something.
function whenSpace(does) {
  document.addEventListener("keydown", (event) => {
    if (event.key !== " " || event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey) return;
    const own = "button, select, summary, textarea, a[href], input:not([type=range])";
    if (event.target.closest?.(own)) return;
    event.preventDefault();
    does();
  });
}
