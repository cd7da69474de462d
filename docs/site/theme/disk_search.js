// Search in a site that is opened from a disk, where browsers refuse workers and requests. The index is a script, loaded
// when the search field gets the focus. A hidden frame replaces the worker.
var __search = {
  index: new Promise((resolve) => {
    const file = document.currentScript.src.replace("disk_search.js", "search/search_index.js");
    window.take_search_index = resolve;
    const load = (event) => {
      if (!event.target.matches("[data-md-component=search-query]")) return;
      document.removeEventListener("focusin", load);
      const script = document.createElement("script");
      script.src = file;
      document.head.append(script);
    };
    document.addEventListener("focusin", load);
  }),
};

window.Worker = class extends EventTarget {
  constructor(url) {
    super();
    const frame = document.createElement("iframe");
    frame.hidden = true;
    document.body.append(frame);
    const inner = frame.contentWindow;
    inner.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
    const script = frame.contentDocument.createElement("script");
    script.src = url;
    this.inner = new Promise((resolve) => (script.onload = () => resolve(inner)));
    frame.contentDocument.body.append(script);
  }
  postMessage(data) {
    this.inner.then((inner) => inner.dispatchEvent(new MessageEvent("message", { data })));
  }
};
