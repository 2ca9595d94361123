// What all pages share: elements, keys that work wherever the focus is, tables that can be sorted.

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes))
    if (name in made && name !== "list") made[name] = value;
    else made.setAttribute(name, value);
  made.append(...children);
  return made;
}

// Whether the focus came where it is by keys: what was clicked does not take Space.
let reachedByKeys = false;
document.addEventListener("pointerdown", () => (reachedByKeys = false), true);
document.addEventListener("keydown", ({ key }) => { if (key === "Tab") reachedByKeys = true; }, true);

// Space anywhere but where it types, presses or opens something.
function whenSpace(does) {
  document.addEventListener("keydown", (event) => {
    if (event.key !== " " || event.defaultPrevented || event.ctrlKey || event.altKey || event.metaKey) return;
    const own = event.target.closest?.("button, select, summary, textarea, input:not([type=range])");
    if (own && (reachedByKeys || own.matches("textarea, input[type=search]"))) return;
    event.preventDefault();
    does();
  });
  document.addEventListener("keyup", (event) => {
    if (event.key === " " && event.target.tagName === "BUTTON" && !reachedByKeys) event.preventDefault();
  });
}

// The number that a cell begins with; NaN where it begins with none.
function numberIn(cell) {
  return parseFloat(cell.textContent.trim().replaceAll("−", "-").replaceAll(",", ""));
}

// Rows by a column: numbers before texts, each in their order; what is empty comes last.
function compared(column, way) {
  return (a, b) => {
    const [x, y] = [a.cells[column], b.cells[column]], [m, n] = [numberIn(x), numberIn(y)];
    const [s, t] = [x.textContent.trim(), y.textContent.trim()];
    if (!s || !t) return (s ? 0 : 1) - (t ? 0 : 1);
    if (Number.isNaN(m) !== Number.isNaN(n)) return Number.isNaN(m) ? 1 : -1;
    return way * (Number.isNaN(m) ? s.localeCompare(t, "en", { numeric: true }) : m - n);
  };
}

// A press on a heading sorts upwards, another one downwards, a third as it was; each group for itself.
function makeSortable(table) {
  const heads = [...(table.tHead?.rows[0]?.cells ?? [])];
  const bodies = [...table.tBodies].map((body) => [body, [...body.rows].filter((row) => !row.matches(".group"))]);
  if (!heads.length || !bodies.some(([, rows]) => rows.length > 1)) return;
  heads.forEach((head, column) => {
    const button = element("button", { type: "button", className: "sort", title: "Sort" }, ...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const was = head.getAttribute("aria-sort"), now = was === "ascending" ? "descending" : was === "descending" ? null : "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      if (now) head.setAttribute("aria-sort", now);
      for (const [body, rows] of bodies) body.append(...(now ? [...rows].sort(compared(column, now === "ascending" ? 1 : -1)) : rows));
    });
  });
}

for (const table of document.querySelectorAll("table:not(.live, .unsorted)")) makeSortable(table);
