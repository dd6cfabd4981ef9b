// Puts a player into each box of class "recording". Recordings are in recordings.js, since a page that is opened as
// a file may not fetch others.
for (const box of document.querySelectorAll(".recording")) {
  AsciinemaPlayer.create({ data: RECORDINGS[box.dataset.name] }, box, {
    fit: "width",
    idleTimeLimit: 2,
    poster: "npt:0:15",
    terminalFontFamily: "'DejaVu Sans Mono', 'Menlo', 'Consolas', monospace",
  });
}
