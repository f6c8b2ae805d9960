// SPDX-License-Identifier: GPL-3.0-or-later

// Makes search work on pages opened from a folder. Browsers refuse workers there, so the search worker runs in a hidden
// frame instead, with the functions of a worker that it calls.
(() => {
  if (location.protocol !== "file:") return;

  class FrameWorker extends EventTarget {
    constructor(url) {
      super();
      this.frame = document.createElement("iframe");
      this.frame.hidden = true;
      document.documentElement.append(this.frame);
      const scope = this.frame.contentWindow;
      scope.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      const script = scope.document.createElement("script");
      script.src = new URL(url, document.baseURI).href;
      this.isLoaded = new Promise((resolve) => (script.onload = resolve));
      scope.document.head.append(script);
    }

    postMessage(data) {
      this.isLoaded.then(() => {
        const { MessageEvent: FrameEvent } = this.frame.contentWindow;
        this.frame.contentWindow.dispatchEvent(new FrameEvent("message", { data }));
      });
    }

    terminate() {
      this.frame.remove();
    }
  }

  window.Worker = FrameWorker;
})();
