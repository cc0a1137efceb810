"""Raw meshes to repaired, normalised ones.

Inputs: the sources named in the config. Outputs: zips of watertight meshes, a shard each; one catalogue a
category, which is the only register of what was taken, filled or rejected, and why; point clouds of the raw
surfaces, for the feature extractor and as the reference of FID.
"""


rule repair_shapes:
    output:
        meshes="<results>/data/{category}/{scatteritem}.zip",
    log:
        "<logs>/repair_shapes/{category}/{scatteritem}.log",
    benchmark:
        "<benchmarks>/repair_shapes/{category}/{scatteritem}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=2000,
    params:
        source=section("sources", "{category}"),
        repair=section("repair"),
        margin=config["normalise"]["margin"],
        code=code_digest("tetgan.shapes.shards:repair_shard"),
    shell:
        "tetgan repair {output.meshes:q} --category {wildcards.category} --shard {wildcards.scatteritem}"
        " --source {params.source:q} --options {params.repair:q} --margin {params.margin} >{log:q} 2>&1"


rule gather_catalogue:
    input:
        meshes=gather.shards("<results>/data/{{category}}/{scatteritem}.zip"),
    output:
        catalogue="<results>/data/{category}/catalogue.csv",
    log:
        "<logs>/gather_catalogue/{category}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        split=section("split"),
        code=code_digest("tetgan.shapes.catalogue:gather_catalogue"),
    shell:
        "tetgan gather-catalogue {input.meshes:q} {output.catalogue:q} --split {params.split:q} >{log:q} 2>&1"


rule sample_clouds:
    output:
        clouds="<results>/clouds/{category}.npz",
    log:
        "<logs>/sample_clouds/{category}.log",
    benchmark:
        "<benchmarks>/sample_clouds/{category}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=1500,
    params:
        source=section("sources", "{category}"),
        split=section("split"),
        clouds=section("clouds"),
        margin=config["normalise"]["margin"],
        code=code_digest("tetgan.shapes.cloud_sampling:sample_clouds"),
    shell:
        "tetgan sample-clouds {output.clouds:q} --category {wildcards.category} --source {params.source:q}"
        " --split {params.split:q} --options {params.clouds:q} --margin {params.margin} >{log:q} 2>&1"
