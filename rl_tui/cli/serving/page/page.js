"use strict";

const FONT_SIZE = { usual: 15, least: 8, most: 32 }; // 120 × 40 cells fit into 1280 × 720 pixels
const SAMPLE = "Mg←γ─⣿"; // letters of every face

function fontSize() {
  const wanted = Number(new URLSearchParams(window.location.search).get("fontsize")) || FONT_SIZE.usual;
  return Math.min(Math.max(Math.round(wanted), FONT_SIZE.least), FONT_SIZE.most);
}

function webSocketUrl() {
  const url = new URL("ws", window.location.href.split("?")[0]);
  url.protocol = url.protocol === "https:" ? "wss:" : "ws:";
  url.hash = "";
  return url.href;
}

// The terminal's script keeps its socket to itself: the reason why it was closed is heard here
window.WebSocket = class extends window.WebSocket {
  constructor(...address) {
    super(...address);
    this.addEventListener("open", () => setTimeout(focusTerminal));
    this.addEventListener("close", (event) => {
      const lost = event.code === 1006 ? "The server cannot be reached." : "You left rl-tui.";
      document.getElementById("why").textContent = event.reason || lost;
      setTimeout(() => document.getElementById("again").focus());
    });
  }

  send(data) {
    if (this.readyState === this.OPEN) {
      super.send(data); // it says that it lost the focus when nobody is there any more
    }
  }
};

function focusTerminal() {
  const entry = document.querySelector(".xterm-helper-textarea");
  if (entry && !document.body.classList.contains("-closed")) {
    entry.focus();
  }
}

// Cells are measured once, when the terminal is made: every font must be there before
async function loadFonts(size) {
  const faces = ["", "bold "].map((weight) => document.fonts.load(`${weight}${size}px "Roboto Mono"`, SAMPLE));
  await Promise.allSettled(faces);
}

function loadScript(address) {
  return new Promise((resolve, reject) => {
    const script = document.createElement("script");
    script.src = address;
    script.onload = resolve;
    script.onerror = reject;
    document.body.append(script);
  });
}

async function start() {
  const size = fontSize();
  const terminal = document.getElementById("terminal");
  terminal.dataset.sessionWebsocketUrl = webSocketUrl();
  terminal.dataset.fontSize = String(size);
  await loadFonts(size);
  await loadScript("static/js/textual.js");
  window.onload(new Event("load")); // it waits for an event that is over
}

document.getElementById("again").addEventListener("click", () => window.location.reload());
window.addEventListener("focus", focusTerminal);
window.addEventListener("load", start);
