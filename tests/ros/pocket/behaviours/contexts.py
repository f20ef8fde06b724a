# %% an exception within a context
c = Context()
try:
    with c:
        raise ValueError("mine")
except ValueError as error:
    print(repr(error), c.ok())


# %% a context's shutdown calls callbacks, but no methods of deleted objects
class Caller:
    def __init__(self, name):
        self.name = name

    def call(self):
        print(self.name)


c, kept = Context(), Caller("a method")
attempt(c.on_shutdown, 3)
c.on_shutdown(kept.call)
c.try_shutdown()
c.init(args=[])
c.on_shutdown(lambda: print("a function"))
c.on_shutdown(Caller("a method of what is gone").call)
print("running")
c.shutdown()
c.try_shutdown()
c.on_shutdown(kept.call)
