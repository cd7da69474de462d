// Sorts the rows of a table when the reader clicks a heading, and filters them by a text. Without scripts the rows have
// their original order. A print contains all rows.
(() => {
  /** Returns the first number of a text; NaN if a word precedes it or there is none. */
  const number = (text) => parseFloat(/^[^\p{L}\d-]*(-?\d.*)/u.exec(text)?.[1]);
  /** Compares two cells: numbers by value, others as text; missing values come last. */
  function compare(a, b, sign) {
    if ((a === "–") !== (b === "–")) return a === "–" ? 1 : -1;
    const [x, y] = [number(a), number(b)];
    return sign * (isNaN(x) || isNaN(y) ? a.localeCompare(b, "en", { numeric: true }) : x - y);
  }
  for (const table of document.querySelectorAll("table.sortable")) {
    const body = table.tBodies[0];
    const own = [...body.rows];
    const headings = [...table.tHead.rows[0].cells];
    headings.forEach((heading, column) => {
      const button = document.createElement("button");
      button.append(...heading.childNodes);
      heading.append(button);
      button.addEventListener("click", () => {
        const descending = heading.ariaSort === "ascending";
        const restore = heading.ariaSort === "descending"; // the third click restores the order of the table
        for (const other of headings) other.removeAttribute("aria-sort");
        if (!restore) heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
        const text = (row) => row.cells[column].textContent;
        const rows = restore ? own : [...own].sort((a, b) => compare(text(a), text(b), descending ? -1 : 1));
        body.append(...rows);
      });
    });
    const label = document.createElement("label");
    label.className = "hint";
    const input = Object.assign(document.createElement("input"), { type: "search" });
    const shown = document.createElement("output");
    label.append("Show rows that contain ", input, " ", shown);
    table.parentElement.before(label);
    input.addEventListener("input", () => {
      const words = input.value.toLowerCase().split(/\s+/);
      for (const row of own) {
        const text = row.textContent.toLowerCase();
        row.classList.toggle("hidden", !words.every((word) => text.includes(word)));
      }
      shown.textContent = `${own.filter((row) => !row.classList.contains("hidden")).length} of ${own.length}`;
    });
  }
})();
