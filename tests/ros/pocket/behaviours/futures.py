# %% a future with a result
f = Future()
f.set_result(3)
print(f.done(), f.cancelled(), f.result(), f.result(), f.exception())

# %% a future with another result
f = Future()
f.set_result(3)
f.set_result(4)
print(f.result())

# %% a future with an exception
f = Future()
f.set_exception(KeyError("mine"))
print(f.done(), repr(f.exception()))
attempt(f.result)
attempt(f.result)

# %% a cancelled future gets a result
f = Future()
f.cancel()
f.set_result(3)
print(f.cancelled(), f.done(), f.result())

# %% a future with a result is not cancelled
f = Future()
f.set_result(3)
f.cancel()
print(f.cancelled(), f.done())

# %% callbacks of a future
f = Future()
calls = []
f.add_done_callback(lambda future: calls.append(("first", future is f)))
f.add_done_callback(lambda future: calls.append(("second", future.result())))
f.set_result(3)
print(calls)

# %% a callback of a future that is done
f = Future()
calls = []
f.set_result(3)
f.add_done_callback(lambda future: calls.append(future.result()))
print(calls)

# %% a callback of a future that is cancelled
f = Future()
calls = []
f.add_done_callback(lambda future: calls.append(future.cancelled()))
f.cancel()
f.set_result(3)
print(calls)

# %% a callback that fails
f = Future()
calls = []
f.add_done_callback(lambda future: 1 / 0)
f.add_done_callback(calls.append)
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    f.set_result(3)
print(f.result(), calls == [f], [str(warning.message) for warning in said])

# %% a callback that fails afterwards
f = Future()
f.set_result(3)
f.add_done_callback(lambda future: 1 / 0)

# %% a future that fails after its result
f = Future()
f.set_result(1)
f.set_exception(ValueError("mine"))
attempt(f.result)
print(f.exception())
