// Lets the search work in pages that are opened as files. There a browser starts no workers, so the script of the
// worker runs in a hidden frame, whose messages are handed on.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.body.append(this.frame);
      const inner = this.frame.contentWindow;
      inner.postMessage = (data) => this.deliver(this, data);
      inner.importScripts = () => {};
      this.ready = new Promise((resolve) => {
        const script = inner.document.createElement("script");
        script.src = new URL(url, location.href).href;
        script.addEventListener("load", resolve);
        inner.document.body.append(script);
      });
    }

    deliver(receiver, data) {
      const message = new MessageEvent("message", { data: structuredClone(data) });
      setTimeout(() => {
        receiver.dispatchEvent(message);
        if (receiver === this && this.onmessage) this.onmessage(message);
      });
    }

    postMessage(data) {
      this.ready.then(() => this.deliver(this.frame.contentWindow, data));
    }

    terminate() {
      this.frame.remove();
    }
  };
}
