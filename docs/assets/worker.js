// Browsers start no Worker from file://. This stand-in runs the script of the search in a hidden frame instead.
if (location.protocol === "file:") {
  window.Worker = window.IFrameWorker = class extends EventTarget {
    constructor(url) {
      super()
      const frame = document.createElement("iframe")
      frame.hidden = true
      document.documentElement.append(frame)
      const page = frame.contentDocument
      page.open()
      page.write("<!doctype html><title>search</title><body>")
      page.close()
      const inside = frame.contentWindow
      const load = src => new Promise(done => {
        const script = page.createElement("script")
        script.src = src
        script.onload = done
        page.body.append(script)
      })
      inside.postMessage = data => this.dispatchEvent(new MessageEvent("message", { data }))
      inside.importScripts = (...all) => all.reduce((before, src) => before.then(() => load(src)), Promise.resolve())
      this.inside = load(new URL(url, document.baseURI).href).then(() => inside)
    }

    postMessage(data) {
      this.inside.then(inside => inside.dispatchEvent(new inside.MessageEvent("message", { data })))
    }

    terminate() {}
  }
}
