# %% a failing callback
f = Future()
calls = []
f.add_done_callback(lambda future: 1 / 0)
f.add_done_callback(calls.append)
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    f.set_result(3)
print(f.result(), calls == [f], [str(warning.message) for warning in said])
