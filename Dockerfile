# An image with the course, for Docker, Binder and JupyterHub. Its stage `dev`, without the course, is the dev container.
#
#   docker build -t tank-tutorial .
#   docker run --rm -it -p 127.0.0.1:8888:8888 tank-tutorial
#
# On ARM, pass --platform linux/amd64 to both, because PyPI has no Cyclone DDS for Linux on ARM. This has not been tested.
#
# Learners' files are below /home/learner, where a hub mounts the learner's own volume.

FROM python:3.13-slim-trixie AS base
RUN apt-get update \
    && apt-get install -y --no-install-recommends bubblewrap git keyutils libegl1 libgl1 libseccomp2 make \
    && rm -rf /var/lib/apt/lists/*
ARG NB_USER=learner
ARG NB_UID=1000
ENV HOME=/home/${NB_USER}
RUN useradd --create-home --uid ${NB_UID} --shell /bin/bash ${NB_USER}
WORKDIR ${HOME}
USER ${NB_USER}

FROM base AS dev
USER root
RUN apt-get update \
    && apt-get install -y --no-install-recommends chromium curl npm sudo \
    && rm -rf /var/lib/apt/lists/* \
    && echo "${NB_USER} ALL=(ALL) NOPASSWD: ALL" >/etc/sudoers.d/learner
USER ${NB_USER}

FROM base AS wheels
COPY . /source
RUN python -m pip wheel --no-deps -w /tmp/wheels /source /source/tutorial/ros/pocket

FROM base
USER root
RUN --mount=type=bind,from=wheels,source=/tmp/wheels,target=/tmp/wheels \
    --mount=type=bind,source=constraints.txt,target=/tmp/constraints.txt \
    python -m pip install --no-cache-dir -c /tmp/constraints.txt /tmp/wheels/*.whl jupyterhub
USER ${NB_USER}
RUN python -c "from tutorial.commands.lab import own_course, trust; trust(own_course() / 'notebooks')"
EXPOSE 8888
CMD ["tank", "lab", "--", "--no-browser", "--ServerApp.ip=0.0.0.0"]
