// What the widgets with a page of their own have in common: the page's side of tutorial/notebook/widgets/cell_widget.py.

const LOST = new Set(["restarting", "autorestarting", "terminating", "dead"]);

/** Say something to the kernel, unless the widget has been closed there. */
function send(model, message) {
  try {
    model.send(message);
  } catch (error) {
    console.debug("the widget is closed:", error);
  }
}

/**
 * Tell when the kernel has ended, for good as far as its widgets go, and when the connection to it is lost or there again.
 * Returns how to stop. Only JupyterLab lets its widgets see the kernel.
 */
function watchKernel(model, onEnd, onConnection) {
  const kernel = model.widget_manager?.kernel;
  let isConnected = true;
  const stop = () => {
    kernel?.statusChanged.disconnect(onStatus);
    kernel?.connectionStatusChanged.disconnect(onConnectionStatus);
    kernel?.disposed.disconnect(end);
  };
  const end = () => {
    stop();
    onEnd();
  };
  const onStatus = (_, status) => {
    if (LOST.has(status)) end();
  };
  const onConnectionStatus = (_, status) => {
    if (isConnected === (status === "connected")) return;
    isConnected = !isConnected;
    onConnection(isConnected);
  };
  kernel?.statusChanged.connect(onStatus);
  kernel?.connectionStatusChanged.connect(onConnectionStatus);
  kernel?.disposed.connect(end);
  return stop;
}
