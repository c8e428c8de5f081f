"use strict";
{
  const table = document.getElementById("chains");
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  const words = new Intl.Collator("en", { numeric: true, sensitivity: "base" });

  // A row's cell in a column; null where one cell spans that column and others.
  const cellAt = (row, column) => {
    let at = 0;
    for (const cell of row.cells) {
      if (at === column) return cell.colSpan === 1 ? cell : null;
      at += cell.colSpan;
    }
    return null;
  };

  // What a row is sorted by before that: numbers of different units are not compared.
  const unitOf = (row, column) => cellAt(row, column)?.dataset.unit ?? "";

  // What a row is sorted by; null where nothing is known.
  const keyOf = (row, column, kind) => {
    const cell = cellAt(row, column);
    if (cell === null) return null;
    if (cell.dataset.value !== undefined) return Number(cell.dataset.value);
    return kind === "words" ? cell.textContent.trim() : null;
  };

  // Up, then down, then as they were asked for.
  const asked = [...body.rows];
  const ways = [["ascending", 1], ["descending", -1], [null, 0]];
  const sort = (column) => {
    const head = heads[column];
    const [name, direction] = ways[(ways.findIndex(([way]) => way === head.getAttribute("aria-sort")) + 1) % 3];
    const rows = (direction === 0 ? asked : [...body.rows])
      .map((row) => ({ row, key: keyOf(row, column, head.dataset.kind), unit: unitOf(row, column) }));
    rows.sort((a, b) => {
      if (direction === 0) return 0;
      if (a.key === null || b.key === null) return (a.key === null) - (b.key === null);
      if (a.unit !== b.unit) return words.compare(a.unit, b.unit);
      return direction * (typeof a.key === "number" ? a.key - b.key : words.compare(a.key, b.key));
    });
    body.append(...rows.map(({ row }) => row));
    heads.forEach((other) => other.removeAttribute("aria-sort"));
    if (name !== null) head.setAttribute("aria-sort", name);
  };

  const buttons = heads.map((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    button.addEventListener("click", () => sort(column));
    head.append(button);
    return button;
  });

  const search = document.getElementById("search");
  const status = document.getElementById("status");
  const joints = document.getElementById("joints");
  const count = document.getElementById("count");
  const jointsColumn = 2;

  const wanted = (row) => {
    const { search: text, status: how, errors, fails, disagree } = row.dataset;
    const asked = { "": true, done: how === "done", failed: how === "failed",
      errors: errors !== undefined, fails: fails !== undefined, disagree: disagree !== undefined };
    const number = keyOf(row, jointsColumn, "number"); // a robot that failed has none: it stays
    return asked[status.value]
      && search.value.toLowerCase().split(/\s+/).every((word) => text.toLowerCase().includes(word))
      && (number === null || number >= Number(joints.value));
  };

  const filter = () => {
    let chains = 0, others = 0;
    for (const row of body.rows) {
      row.hidden = !wanted(row);
      if (!row.hidden && row.dataset.chain !== undefined) chains += 1;
      else if (!row.hidden) others += 1;
    }
    const more = others ? `, and ${others} ${others === 1 ? "robot" : "robots"} without a chain` : "";
    count.textContent = `${chains} of ${count.dataset.chains} chains${more}`;
  };
  [search, status, joints].forEach((control) => control.addEventListener("input", filter));
  document.getElementById("filters").hidden = false;
  filter();

  const robots = [...document.querySelectorAll("details.robot")];
  const folding = document.getElementById("folding");
  folding.hidden = robots.length < 2;
  folding.addEventListener("click", (event) => {
    const { fold } = event.target.dataset;
    if (fold) robots.forEach((robot) => { robot.open = fold === "open"; });
  });

  // A link leads to what is folded: unfold it and all that it is in.
  const reveal = () => {
    let id = location.hash.slice(1);
    try { id = decodeURIComponent(id); } catch { return; }
    const target = document.getElementById(id);
    if (target === null) return;
    for (let at = target; at !== null; at = at.parentElement) if (at.localName === "details") at.open = true;
    target.scrollIntoView();
  };
  addEventListener("hashchange", reveal);
  document.addEventListener("click", (event) => {
    // Once more to the same place: there is no hashchange.
    const link = event.target.closest("a[href^='#']");
    if (link !== null && link.getAttribute("href") === location.hash) reveal();
  });
  if (location.hash) reveal();

  // All of it goes on paper; afterwards it is folded as before. A header with buttons would not repeat on each page.
  let folded = [];
  addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details:not([open])")];
    folded.forEach((one) => { one.open = true; });
    buttons.forEach((button) => button.replaceWith(...button.childNodes));
  });
  addEventListener("afterprint", () => {
    folded.forEach((one) => { one.open = false; });
    buttons.forEach((button, column) => {
      button.append(...heads[column].childNodes);
      heads[column].append(button);
    });
  });
}
