"use strict";

const FONT_SIZE = { usual: 15, least: 8, most: 32 }; // 120 × 40 cells fit into 1280 × 720 pixels
const SAMPLE = "Mg←γ─⣿"; // letters of every face
const NEEDED = "⣿★◉←"; // whoever has these has the others
const MISSING = "\u{10fffd}"; // drawn as what no font has

function fontSize() {
  const wanted = Number(new URLSearchParams(window.location.search).get("fontsize")) || FONT_SIZE.usual;
  return Math.min(Math.max(Math.round(wanted), FONT_SIZE.least), FONT_SIZE.most);
}

// The curve is made of Braille: where no font has it, it would be blank, and a terminal cannot tell the app
function canDraw(character) {
  const shape = (text) => {
    const context = document.createElement("canvas").getContext("2d");
    context.font = '24px "Roboto Mono"';
    context.fillText(text, 0, 40);
    return context.getImageData(0, 0, 60, 60).data.join();
  };
  return shape(character) !== shape(MISSING) && shape(character) !== shape(" ");
}

function webSocketUrl() {
  const way = [...NEEDED].every(canDraw) ? "ws" : "ws/ascii";
  const url = new URL(way, window.location.href.split("?")[0]);
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
  await loadFonts(size);
  terminal.dataset.sessionWebsocketUrl = webSocketUrl();
  terminal.dataset.fontSize = String(size);
  await loadScript("static/js/textual.js");
  window.onload(new Event("load")); // it waits for an event that is over
}

document.getElementById("again").addEventListener("click", () => window.location.reload());
window.addEventListener("focus", focusTerminal);
window.addEventListener("load", start);
