// Runs before the first paint, so that the other theme does not flash.
{
  const chosen = localStorage.getItem("fingerpad.theme");
  if (chosen) document.documentElement.dataset.theme = chosen;
}
