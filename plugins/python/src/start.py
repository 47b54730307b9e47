def start():
    import json
    import sys
    import types

    path, prefix, executable = json.loads(installation)
    sys.path[:] = path
    sys.prefix = sys.exec_prefix = prefix
    sys.executable = executable
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.reconfigure(line_buffering=True)
    for name, source in json.loads(sources):
        module = types.ModuleType(name)
        module.__package__ = "saoms"
        if name == "saoms":
            module.__path__ = []
        sys.modules[name] = module
        exec(compile(source, f"<{name}>", "exec"), module.__dict__)
        if name != "saoms":
            setattr(sys.modules["saoms"], name.split(".")[1], module)


start()
