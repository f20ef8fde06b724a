n = start()

# %% a parameter cannot be changed
p = Parameter("a", value=1)
for part in ("name", "value", "type_"):
    try:
        setattr(p, part, 3)
    except AttributeError:
        print("cannot set", part)

# %% no value, no type
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    p = n.declare_parameter("a")
print(p.type_.name, n.get_parameter("a").value, said[0].category.__name__, str(said[0].message).splitlines()[0])
