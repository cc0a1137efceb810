"""Random points with their occupancy, and voxels of signed distance, which the baselines learn from.

Inputs: zips of repaired meshes and the catalogue. Outputs: one Zarr store a shard, and the index that opens
them as one data set.
"""


rule extract_samplings:
    input:
        meshes="<results>/data/{category}/{scatteritem}.zip",
    output:
        sampling="<results>/samplings/{category}/{sampling}/{scatteritem}.zarr.zip",
    log:
        "<logs>/extract_samplings/{category}/{sampling}/{scatteritem}.log",
    benchmark:
        "<benchmarks>/extract_samplings/{category}/{sampling}/{scatteritem}.tsv"
    conda:
        "../envs/tetgan.yaml"
    threads: 1
    resources:
        mem_mb=1500,
    params:
        sampling=section("samplings", "{sampling}"),
        code=code_digest("tetgan.fields.samplings:extract_samplings"),
    shell:
        "tetgan extract-samplings {input.meshes:q} {output.sampling:q} --sampling {params.sampling:q}"
        " --threads {threads} >{log:q} 2>&1"


rule index_samplings:
    input:
        shards=gather.shards(
            "<results>/samplings/{{category}}/{{sampling}}/{scatteritem}.zarr.zip"
        ),
        catalogue="<results>/data/{category}/catalogue.csv",
    output:
        index="<results>/samplings/{category}/{sampling}/index.json",
    log:
        "<logs>/index_samplings/{category}/{sampling}.log",
    conda:
        "../envs/tetgan.yaml"
    resources:
        mem_mb=500,
    params:
        sampling=section("samplings", "{sampling}"),
        code=code_digest("tetgan.fields.samplings:index_samplings"),
    shell:
        "tetgan index {input.shards:q} {output.index:q} --catalogue {input.catalogue:q}"
        " --sampling {params.sampling:q} >{log:q} 2>&1"
