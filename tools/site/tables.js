// A long name in the last columns of a wide table breaks where its parts begin.
for (const name of document.querySelectorAll("td:nth-child(n + 4) code .pre")) {
  name.innerHTML = name.innerHTML.replace(/(?<=.)(?=[.[(])|(?<=[^/]_|.\/)(?=.)/g, "<wbr>");
}

// A table of words that is wider than a phone becomes a card for each row; a table of numbers scrolls.
const tables = [...document.querySelectorAll("table.docutils")].filter((table) =>
  [...table.querySelectorAll("td")].some((cell) => /[a-z]+ [a-z]+ [a-z]+/i.test(cell.textContent))
);
for (const table of tables) {
  const names = [...table.querySelectorAll("thead th")].map((cell) => cell.textContent.trim());
  for (const row of table.querySelectorAll("tbody tr")) {
    [...row.cells].forEach((cell, column) => {
      if (cell.textContent.trim()) cell.dataset.label = names[column];
    });
  }
}
function fit() {
  for (const table of tables) {
    table.classList.remove("cards");
    table.classList.toggle("cards", table.parentElement.scrollWidth > table.parentElement.clientWidth + 1);
  }
}
window.addEventListener("load", fit);
window.addEventListener("resize", fit);
